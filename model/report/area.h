// SPDX-License-Identifier: Apache-2.0
// What a machine costs in area: lookup tables, registers and RAM by unit, and square millimetres.
// The structure of each unit is counted; the paper's Table I and its total of 5.4 mm2 are the only
// things it is calibrated on, so for its own configuration it returns them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/config/machine_config.h"

namespace fasttree::model {

/// Resources as an FPGA reports them.
struct Resources {
  double luts = 0;       ///< six-input lookup tables
  double registers = 0;  ///< flip-flops
  double ram_kbits = 0;  ///< RAM in blocks; 1 kbit is 1024 bits

  Resources& operator+=(const Resources& b) {
    luts += b.luts;
    registers += b.registers;
    ram_kbits += b.ram_kbits;
    return *this;
  }
  friend Resources operator+(Resources a, const Resources& b) { return a += b; }
  friend Resources operator-(const Resources& a, const Resources& b) {
    return {a.luts - b.luts, a.registers - b.registers, a.ram_kbits - b.ram_kbits};
  }
  friend Resources operator*(double n, const Resources& a) {
    return {n * a.luts, n * a.registers, n * a.ram_kbits};
  }
};

/// A process the paper gives figures for.
enum class Process : std::uint8_t { nm65, nm28 };

/// Two-input NAND gates that take as much room: a LUT or a register 6, a bit of RAM 0.7. These are
/// common rules of thumb; only their proportion matters.
double gates_of(const Resources& resources);

/// One factor from gates to area, in which the paper's machine (all of Table I) is 5.4 mm2 in 65
/// nm; in 28 nm it is the paper's upper bound of 1.4 mm2.
double mm2_of(const Resources& resources, Process process);

/// All units of one kind.
struct AreaRow {
  std::string kind;  ///< UnitRecord's kind or the stem of its name, or what is no unit: "control"
  std::uint32_t count = 1;
  Resources resources;  ///< of all of them
  double mm2_65nm = 0;
  double mm2_28nm = 0;
};

struct AreaReport {
  std::vector<AreaRow> rows;
  Resources total;
  double mm2_65nm = 0;
  double mm2_28nm = 0;

  void add(std::string kind, std::uint32_t count, const Resources& resources);
};

/// Of a paper's machine by its structure against Table I; of fasttree-2 by its blocks
/// (model/fasttree2/area.h), at the same size of a gate.
AreaReport area(const MachineConfig& config);

/// A unit's name without its number: "lane" of "lane2".
std::string unit_stem(const std::string& name);

/// What the report rests on, in one sentence, to be printed with it.
const char* area_basis();

}  // namespace fasttree::model
