// SPDX-License-Identifier: Apache-2.0
// The longest path of a netlist of mapped Virtex-7 cells.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "rtl/synth/netlist.h"
#include "rtl/synth/xc7_cells.h"

namespace fasttree::synth {

struct Step {
  std::string cell;    ///< type, or "port"
  std::string signal;  ///< what it drives, where the source has a name for it
  double ns = 0;       ///< arrival at its output, or at the end of the path
};

struct Path {
  double ns = 0;   ///< 0 where there is none
  int levels = 0;  ///< cells between the two ends
  std::vector<Step> steps;

  double mhz() const { return ns > 0 ? 1000 / ns : 0; }
};

struct Timing {
  Path registers;  ///< from a clocked cell to a clocked cell
  /// Also from and to ports, as if a register stood right behind each of them.
  Path any;
};

struct TimingOptions {
  Delays delays;
  /// Input ports that hold still while their values matter: no path begins there.
  std::set<std::string> still;
};

/// Throws std::runtime_error for a loop of combinational cells, naming one of them.
Timing analyse(const Netlist& netlist, const TimingOptions& options);

}  // namespace fasttree::synth
