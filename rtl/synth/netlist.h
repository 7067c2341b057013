// SPDX-License-Identifier: Apache-2.0
// A netlist as Yosys' write_json leaves it: one flat module of cells.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace fasttree::synth {

/// A wire of one bit: its number in the netlist, or kConstant where a pin is tied or open.
using Net = int;
inline constexpr Net kConstant = -1;

struct Cell {
  std::string name;
  std::string type;
  std::map<std::string, std::string> parameters;  ///< as Yosys writes them: binary digits
  std::map<std::string, std::vector<Net>> inputs, outputs;

  /// A parameter as a number; `otherwise` where the cell does not have it.
  long long parameter(const std::string& key, long long otherwise) const;
};

struct Netlist {
  std::vector<Cell> cells;
  std::map<std::string, std::vector<Net>> inputs, outputs;  ///< ports
  std::vector<std::string> names;                           ///< by net; empty where it has none

  std::size_t nets() const { return names.size(); }
};

/// Of the module named; throws std::runtime_error where the text is not such a netlist.
Netlist read_netlist(const std::string& json, const std::string& module);

}  // namespace fasttree::synth
