// SPDX-License-Identifier: Apache-2.0
// What a unit takes, counted in its netlists.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "rtl/synth/netlist.h"
#include "rtl/synth/timing.h"

namespace fasttree::synth {

/// On the FPGA. Two small functions that a vendor's tool would put into one LUT count as two.
struct FpgaFigures {
  int luts = 0;  ///< all of them: logic, memory, shift registers
  int memory_luts = 0, shift_luts = 0;
  int flip_flops = 0;
  int bram18 = 0, bram36 = 0;
  int dsp = 0, carry4 = 0, wide_muxes = 0;

  int bram_kbits() const { return 18 * bram18 + 36 * bram36; }
  /// As devices are described: 64 bits a LUT.
  double lutram_kbits() const { return memory_luts * 64 / 1024.0; }
};
FpgaFigures count_xc7(const Netlist& netlist);

/// As standard cells. Memories that were left as memories are counted by their bits.
struct AsicFigures {
  double cell_um2 = 0;
  double nand2_um2 = 0;
  int cells = 0, flip_flops = 0;
  long long memory_bits = 0;

  double gates() const { return nand2_um2 > 0 ? cell_um2 / nand2_um2 : 0; }
};
/// Areas by cell of a Liberty file, as far as they are needed here.
std::map<std::string, double> read_areas(const std::string& liberty);
/// Throws std::runtime_error for a cell that is neither of the library nor a memory.
AsicFigures count_asic(const Netlist& netlist, const std::map<std::string, double>& areas);

nlohmann::ordered_json json_of(const FpgaFigures& figures);
nlohmann::ordered_json json_of(const Timing& timing);
/// `delay_ns`: the longest path as ABC gave it, without wires and flip-flops.
nlohmann::ordered_json json_of(const AsicFigures& figures, double delay_ns);

/// The paper's clock, in MHz.
inline constexpr double kPaperMhz = 163;

}  // namespace fasttree::synth
