// SPDX-License-Identifier: Apache-2.0
// What the cells of a Virtex-7 of speed grade -2 take, in nanoseconds: an estimate before
// placement.
#pragma once

#include <string>
#include <vector>

#include "rtl/synth/netlist.h"

namespace fasttree::synth {

/// The table, all of it. Figures are rounded up from public data sheets and timing reports of the
/// family; docs/accelerator/synthesis.md says how far they can be trusted.
struct Delays {
  double lut = 0.10;    ///< any input to O
  double muxf7 = 0.20;  ///< data or select to O
  double muxf8 = 0.15;
  double carry_in_s = 0.30;   ///< S or DI to any CO
  double carry_out = 0.25;    ///< S, DI or CI to O
  double carry_ci_co = 0.06;  ///< CI to CO, four bits
  double ff_clock_to_q = 0.26;
  double ff_setup = 0.05;      ///< D
  double ff_control = 0.30;    ///< CE, R, S
  double lutram_read = 0.10;   ///< address to data: it is a LUT
  double lutram_clock = 0.98;  ///< clock to data, of a cell that is read while it is written
  double lutram_setup = 0.30;  ///< data, address, enable
  double bram_clock = 1.80;    ///< clock to data, without the register at the output
  double bram_clock_reg = 0.63;
  double bram_setup = 0.45;
  double dsp_multiply = 3.30;        ///< A, B, D to P without registers
  double dsp_add = 1.40;             ///< C or a cascade to P
  double dsp_setup_multiply = 2.60;  ///< A, B to P's register, without one in between
  double dsp_setup_add = 1.30;       ///< C to P's register
  double dsp_setup = 0.35;           ///< to a register at an input
  double dsp_from_input = 3.30;      ///< input register to P without further registers
  double dsp_from_m = 1.70;          ///< multiplier's register to P
  double dsp_from_p = 0.40;          ///< P's register to P
  double net = 0.35;                 ///< a wire to one sink
  double net_per_doubling = 0.09;    ///< more for each doubling of the sinks
  double net_most = 1.40;            ///< a driver of more is copied by any tool
};

/// From one pin of a cell to another.
struct Arc {
  Net from, to;
  double ns;
  std::string pin;  ///< of `from`
};
/// Where a path begins or ends in a cell: what the clock does there.
struct Clocked {
  Net net;
  double ns;
  std::string pin;
};
struct CellTiming {
  std::vector<Arc> arcs;
  std::vector<Clocked> starts, ends;
};

/// Throws std::runtime_error for a cell that is not of the list: a latch, a black box.
CellTiming timing_of(const Cell& cell, const Delays& delays);

/// A wire from a cell's output to a pin of another. `sinks` is how many pins it drives.
double net_delay(const std::string& driver, const std::string& sink, const std::string& pin,
                 std::size_t sinks, const Delays& delays);

/// LUTs that a cell takes as memory or shift register, 0 for others.
int memory_luts(const std::string& type);
bool is_shift_register(const std::string& type);
bool is_lut(const std::string& type);
bool is_flip_flop(const std::string& type);

}  // namespace fasttree::synth
