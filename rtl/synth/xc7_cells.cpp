// SPDX-License-Identifier: Apache-2.0
#include "rtl/synth/xc7_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace fasttree::synth {
namespace {

bool starts_with(const std::string& text, const char* head) {
  return text.rfind(head, 0) == 0;
}

bool is_clock(const std::string& pin) {
  return pin == "C" || pin == "CLK" || pin == "WCLK" || starts_with(pin, "CLKARDCLK") ||
         starts_with(pin, "CLKBWRCLK") || starts_with(pin, "REGCLK");
}

void arcs_all(const Cell& cell, double ns, CellTiming& timing) {
  for (const auto& [in, froms] : cell.inputs) {
    for (const auto& [out, tos] : cell.outputs) {
      for (const Net from : froms) {
        for (const Net to : tos) timing.arcs.push_back({from, to, ns, in});
      }
    }
  }
}

void starts_of(const std::vector<Net>& nets, double ns, const std::string& pin,
               CellTiming& timing) {
  for (const Net net : nets) timing.starts.push_back({net, ns, pin});
}

void ends_of(const std::vector<Net>& nets, double ns, const std::string& pin, CellTiming& timing) {
  for (const Net net : nets) timing.ends.push_back({net, ns, pin});
}

// CARRY4: O[i] and CO[i] depend on S and DI of the places up to i, and on what comes in.
void carry(const Cell& cell, const Delays& d, CellTiming& timing) {
  for (const auto& [pin, froms] : cell.inputs) {
    const bool bitwise = pin == "S" || pin == "DI";
    for (std::size_t i = 0; i < froms.size(); ++i) {
      for (const auto& [out, tos] : cell.outputs) {
        for (std::size_t o = bitwise ? i : 0; o < tos.size(); ++o) {
          // DI does not reach the sum of its own place.
          if (pin == "DI" && out == "O" && o == i) continue;
          const double in = bitwise ? d.carry_in_s : d.carry_ci_co;
          const bool sum_only = out == "O" && (!bitwise || o == i);
          double ns = out == "CO" ? in : sum_only ? d.carry_out : in + d.carry_out;
          if (out == "CO" && !bitwise) ns = d.carry_ci_co;
          timing.arcs.push_back({froms[i], tos[o], ns, pin});
        }
      }
    }
  }
}

void block_ram(const Cell& cell, const Delays& d, CellTiming& timing) {
  for (const auto& [pin, nets] : cell.outputs) {
    const bool a = pin.find('A') != std::string::npos;
    const bool reg = cell.parameter(a ? "DOA_REG" : "DOB_REG", 0) != 0;
    starts_of(nets, reg ? d.bram_clock_reg : d.bram_clock, pin, timing);
  }
  for (const auto& [pin, nets] : cell.inputs) {
    if (!is_clock(pin)) ends_of(nets, d.bram_setup, pin, timing);
  }
}

// A registered input ends a path and begins another one; what is not registered goes through.
void dsp(const Cell& cell, const Delays& d, CellTiming& timing) {
  const bool m = cell.parameter("MREG", 1) != 0, p = cell.parameter("PREG", 1) != 0;
  const bool multiplies = cell.parameters.count("USE_MULT") == 0 ||
                          cell.parameters.at("USE_MULT").rfind("NONE", 0) != 0;
  const std::map<std::string, const char*> registers = {{"A", "AREG"}, {"ACIN", "AREG"},
                                                        {"B", "BREG"}, {"BCIN", "BREG"},
                                                        {"C", "CREG"}, {"D", "DREG"}};
  bool registered_input = false;
  for (const auto& [pin, nets] : cell.inputs) {
    if (is_clock(pin)) continue;
    const auto own = registers.find(pin);
    const bool factor = multiplies && pin != "C" && own != registers.end();
    const bool data = own != registers.end() || pin == "PCIN" || pin == "CARRYIN";
    if (!data || (own != registers.end() && cell.parameter(own->second, 1) != 0)) {
      registered_input = registered_input || data;
      ends_of(nets, d.dsp_setup, pin, timing);
    } else if (factor && m) {
      ends_of(nets, d.dsp_setup_multiply, pin, timing);
    } else if (p) {
      ends_of(nets, factor ? d.dsp_setup_multiply : d.dsp_setup_add, pin, timing);
    } else {
      for (const auto& [out, tos] : cell.outputs) {
        for (const Net from : nets) {
          for (const Net to : tos) {
            timing.arcs.push_back({from, to, factor ? d.dsp_multiply : d.dsp_add, pin});
          }
        }
      }
    }
  }
  for (const auto& [pin, nets] : cell.outputs) {
    if (p) {
      starts_of(nets, d.dsp_from_p, pin, timing);
    } else if (m) {
      starts_of(nets, d.dsp_from_m, pin, timing);
    } else if (registered_input) {
      starts_of(nets, d.dsp_from_input, pin, timing);
    }
  }
}

}  // namespace

bool is_lut(const std::string& type) {
  return type == "INV" || (type.size() == 4 && starts_with(type, "LUT"));
}

bool is_flip_flop(const std::string& type) {
  return type == "FDRE" || type == "FDSE" || type == "FDCE" || type == "FDPE" || type == "FDRE_1" ||
         type == "FDSE_1";
}

bool is_shift_register(const std::string& type) {
  return type == "SRL16E" || type == "SRLC32E" || type == "SRLC16E";
}

int memory_luts(const std::string& type) {
  static const std::map<std::string, int> luts = {
      {"RAM32M", 4},    {"RAM64M", 4},    {"RAM32X1D", 2},  {"RAM64X1D", 2},
      {"RAM128X1D", 4}, {"RAM128X1S", 2}, {"RAM256X1S", 4}, {"RAM32X1S", 1},
      {"RAM64X1S", 1},  {"SRL16E", 1},    {"SRLC16E", 1},   {"SRLC32E", 1}};
  const auto found = luts.find(type);
  return found == luts.end() ? 0 : found->second;
}

CellTiming timing_of(const Cell& cell, const Delays& d) {
  CellTiming timing;
  if (is_lut(cell.type)) {
    arcs_all(cell, d.lut, timing);
  } else if (cell.type == "MUXF7") {
    arcs_all(cell, d.muxf7, timing);
  } else if (cell.type == "MUXF8") {
    arcs_all(cell, d.muxf8, timing);
  } else if (cell.type == "CARRY4") {
    carry(cell, d, timing);
  } else if (is_flip_flop(cell.type)) {
    for (const auto& [pin, nets] : cell.outputs) starts_of(nets, d.ff_clock_to_q, pin, timing);
    for (const auto& [pin, nets] : cell.inputs) {
      if (!is_clock(pin)) ends_of(nets, pin == "D" ? d.ff_setup : d.ff_control, pin, timing);
    }
  } else if (memory_luts(cell.type) > 0) {
    for (const auto& [out, tos] : cell.outputs) starts_of(tos, d.lutram_clock, out, timing);
    for (const auto& [pin, nets] : cell.inputs) {
      if (is_clock(pin)) continue;
      // The write port: of a RAM32M or RAM64M, port D; of the others, A (the read port is DPRA).
      const bool quad = cell.type == "RAM32M" || cell.type == "RAM64M";
      const bool address = starts_with(pin, "A") || starts_with(pin, "DPRA");
      const bool write = !address || (quad && pin == "ADDRD") || (!quad && starts_with(pin, "A"));
      if (write) ends_of(nets, d.lutram_setup, pin, timing);
      if (!address) continue;
      for (const auto& [out, tos] : cell.outputs) {
        // ADDRA reads DOA; A reads SPO, DPRA reads DPO.
        const bool own =
            quad ? out.back() == pin.back() : out != (starts_with(pin, "DPRA") ? "SPO" : "DPO");
        if (!own) continue;
        for (const Net from : nets) {
          for (const Net to : tos) timing.arcs.push_back({from, to, d.lutram_read, pin});
        }
      }
    }
  } else if (starts_with(cell.type, "RAMB18") || starts_with(cell.type, "RAMB36")) {
    block_ram(cell, d, timing);
  } else if (cell.type == "DSP48E1") {
    dsp(cell, d, timing);
  } else {
    throw std::runtime_error("no timing for a cell " + cell.type + " (" + cell.name + ")");
  }
  // What is tied or open takes no part.
  const auto tied = [](const auto& entry) { return entry.net == kConstant; };
  timing.arcs.erase(
      std::remove_if(timing.arcs.begin(), timing.arcs.end(),
                     [](const Arc& arc) { return arc.from == kConstant || arc.to == kConstant; }),
      timing.arcs.end());
  timing.starts.erase(std::remove_if(timing.starts.begin(), timing.starts.end(), tied),
                      timing.starts.end());
  timing.ends.erase(std::remove_if(timing.ends.begin(), timing.ends.end(), tied),
                    timing.ends.end());
  return timing;
}

double net_delay(const std::string& driver, const std::string& sink, const std::string& pin,
                 std::size_t sinks, const Delays& d) {
  // Within a slice nothing is routed: a LUT to its multiplexer or carry, one carry to the next, and
  // the flip-flop behind a cell that drives nothing else.
  const bool slice = is_lut(driver) || driver == "MUXF7" || driver == "MUXF8" ||
                     driver == "CARRY4" || memory_luts(driver) > 0;
  if (sink == "MUXF8" && driver == "MUXF7") return 0;
  if (sink == "MUXF7" && is_lut(driver) && pin != "S") return 0;
  if (sink == "CARRY4" && pin == "CI" && driver == "CARRY4") return 0;
  if (sink == "CARRY4" && pin == "S" && is_lut(driver) && sinks == 1) return 0;
  if (is_flip_flop(sink) && pin == "D" && slice && sinks == 1) return 0;
  const double doublings = sinks > 1 ? std::log2(static_cast<double>(sinks)) : 0;
  return std::min(d.net + d.net_per_doubling * doublings, d.net_most);
}

}  // namespace fasttree::synth
