// SPDX-License-Identifier: Apache-2.0
// The paper's Table I beside what synthesis makes of the RTL.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "output.h"

namespace fasttree::app {

/// A row of Table I beside ours: all modules of one kind, "rest" (what the paper's rows leave of
/// its total), or "all".
struct ModuleResources {
  std::string module;
  int lut = 0, paper_lut = 0;
  int registers = 0, paper_registers = 0;
  int bram_kbits = 0, paper_bram_kbits = 0;
  int dsp = 0;
  double mhz = 0;  ///< of the slowest module; an estimate
  double gates = 0;
  std::string reason;  ///< of a difference, where it is large

  double lut_ratio() const { return static_cast<double>(lut) / paper_lut; }
  double register_ratio() const { return static_cast<double>(registers) / paper_registers; }
};

/// In the paper's order, "all" last.
std::vector<ModuleResources> reproduce_table1();

/// `reasons`: with the reasons, which are long, and with longer headers.
Table table_of(const std::vector<ModuleResources>& rows, bool reasons);
nlohmann::ordered_json json_of(const ModuleResources& row);

/// How ours were found, in one sentence.
const char* table1_basis();

/// Whether the whole design is no larger than the paper's.
bool within_paper(const std::vector<ModuleResources>& rows);

/// The command: prints the table, and writes it as CSV and JSON where asked for. 0, or 1 where the
/// design is larger than the paper's.
int report_table1(Context& context, const std::string& csv);

}  // namespace fasttree::app
