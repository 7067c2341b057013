// SPDX-License-Identifier: Apache-2.0
#include "rtl/synth/figures.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "rtl/synth/xc7_cells.h"

namespace fasttree::synth {
namespace {

using nlohmann::ordered_json;

/// As many places as mean something, so that a report does not change where nothing did.
double rounded(double value, double places) {
  const double scale = std::pow(10, places);
  return std::round(value * scale) / scale;
}

/// "CARRY4 8, LUT6 3": what lies between the two ends.
std::string kinds(const Path& path) {
  std::map<std::string, int> count;
  for (std::size_t i = 1; i + 1 < path.steps.size(); ++i) ++count[path.steps[i].cell];
  std::string text;
  for (const auto& [cell, n] : count) {
    text += (text.empty() ? "" : ", ") + cell + " " + std::to_string(n);
  }
  return text;
}

ordered_json json_of(const Path& path) {
  ordered_json steps = ordered_json::array();
  for (const Step& step : path.steps) {
    std::ostringstream text;
    text.setf(std::ios::fixed);
    text.precision(2);
    text << step.ns << " " << step.cell << (step.signal.empty() ? "" : " " + step.signal);
    steps.push_back(text.str());
  }
  return {{"cells", kinds(path)},
          {"levels", path.levels},
          {"mhz", rounded(path.mhz(), 1)},
          {"ns", rounded(path.ns, 2)},
          {"steps", steps}};
}

}  // namespace

FpgaFigures count_xc7(const Netlist& netlist) {
  FpgaFigures n;
  for (const Cell& cell : netlist.cells) {
    const std::string& type = cell.type;
    if (is_lut(type)) ++n.luts;
    if (const int luts = memory_luts(type); luts > 0) {
      n.luts += luts;
      (is_shift_register(type) ? n.shift_luts : n.memory_luts) += luts;
    }
    if (is_flip_flop(type)) ++n.flip_flops;
    if (type == "RAMB18E1") ++n.bram18;
    if (type == "RAMB36E1") ++n.bram36;
    if (type == "DSP48E1") ++n.dsp;
    if (type == "CARRY4") ++n.carry4;
    if (type == "MUXF7" || type == "MUXF8") ++n.wide_muxes;
  }
  return n;
}

std::map<std::string, double> read_areas(const std::string& liberty) {
  std::map<std::string, double> areas;
  std::istringstream lines(liberty);
  std::string cell;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word, rest;
    words >> word;
    if (word == "cell") {
      const std::size_t open = line.find('('), close = line.find(')');
      if (open == std::string::npos || close == std::string::npos) continue;
      cell = line.substr(open + 1, close - open - 1);
    } else if (word == "area" && !cell.empty()) {
      areas[cell] = std::stod(line.substr(line.find(':') + 1));
      cell.clear();
    }
  }
  return areas;
}

AsicFigures count_asic(const Netlist& netlist, const std::map<std::string, double>& areas) {
  AsicFigures n;
  const auto nand = areas.find("NAND2X1");
  if (nand == areas.end()) throw std::runtime_error("the library has no NAND2X1");
  n.nand2_um2 = nand->second;
  for (const Cell& cell : netlist.cells) {
    if (cell.type == "$mem_v2") {
      n.memory_bits += cell.parameter("SIZE", 0) * cell.parameter("WIDTH", 0);
      continue;
    }
    const auto area = areas.find(cell.type);
    if (area == areas.end()) throw std::runtime_error("no cell of the library: " + cell.type);
    n.cell_um2 += area->second;
    ++n.cells;
    if (cell.type.rfind("DFF", 0) == 0) ++n.flip_flops;
  }
  return n;
}

ordered_json json_of(const FpgaFigures& n) {
  return {{"bram18", n.bram18},
          {"bram36", n.bram36},
          {"bram_kbits", n.bram_kbits()},
          {"carry4", n.carry4},
          {"dsp", n.dsp},
          {"ff", n.flip_flops},
          {"lut", n.luts},
          {"lut_memory", n.memory_luts},
          {"lut_shift", n.shift_luts},
          {"lutram_kbits", rounded(n.lutram_kbits(), 2)},
          {"muxf", n.wide_muxes}};
}

ordered_json json_of(const Timing& timing) {
  return {{"meets_163_mhz", timing.any.mhz() >= kPaperMhz || timing.any.ns == 0},
          {"registers", json_of(timing.registers)},
          {"with_ports", json_of(timing.any)}};
}

ordered_json json_of(const AsicFigures& n, double delay_ns) {
  const double shrink = (65.0 / 180.0) * (65.0 / 180.0);
  return {{"cells", n.cells},
          {"delay_ns_180nm", rounded(delay_ns, 2)},
          {"ff", n.flip_flops},
          {"gates", std::round(n.gates())},
          {"memory_bits", n.memory_bits},
          {"mm2_180nm", rounded(n.cell_um2 / 1e6, 4)},
          {"mm2_65nm", rounded(n.cell_um2 / 1e6 * shrink, 4)}};
}

}  // namespace fasttree::synth
