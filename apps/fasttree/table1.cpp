// SPDX-License-Identifier: Apache-2.0
#include "table1.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "inputs.h"
#include "output.h"
#include "rtl/synth/embedded_reports.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

/// A row of Table I; the last one is its "Overall".
struct PaperRow {
  const char* module;
  int lut;
  int registers;
  int bram_kbits;
};
// Liu, Deng, Ni, Li: FastTree, Table I ("Hardware Resources Usage Result").
constexpr PaperRow kPaper[] = {
    {"SBCU", 2485, 1415, 0},   {"PSU", 11454, 5702, 0},      {"MCGU", 12454, 7561, 0},
    {"RSU", 16530, 50282, 0},  {"LNGU", 8220, 4641, 0},      {"INGU", 9093, 5727, 0},
    {"BEU", 1157, 1086, 0},    {"PCU", 7251, 5562, 0},       {"Cache", 21744, 34295, 172},
    {"rest", 83003, 63786, 0}, {"all", 173391, 180057, 172},
};
constexpr double kPaperMhz = 163;
constexpr double kExplained = 0.25;  // differences over this have a reason

/// What synthesis gave for a row's modules, together.
struct OurRow {
  int lut = 0;
  int registers = 0;
  int bram_kbits = 0;
  int dsp = 0;
  double mhz = 0;  ///< of the slowest; 0: no module
  double gates = 0;
};

double far(double ours, double paper) {
  return paper > 0 ? std::abs(ours / paper - 1) : 0;
}

OurRow our_row(const ordered_json& all, const std::string& row) {
  OurRow sum;
  for (const ordered_json& unit : all["units"]) {
    const int count = unit["count"];
    if (count == 0 || (row != "all" && unit["row"] != row)) continue;
    for (const ordered_json& report : all["reports"]) {
      if (report["unit"] != unit["unit"]) continue;
      const ordered_json& fpga = report["fpga"];
      sum.lut += count * fpga["lut"].get<int>();
      sum.registers += count * fpga["ff"].get<int>();
      sum.bram_kbits += count * fpga["bram_kbits"].get<int>();
      sum.dsp += count * fpga["dsp"].get<int>();
      sum.gates += count * report["asic"]["gates"].get<double>();
      const double mhz = report["timing"]["registers"]["mhz"];
      sum.mhz = sum.mhz == 0 ? mhz : std::min(sum.mhz, mhz);
    }
  }
  return sum;
}

}  // namespace

int reproduce_table1(Context& context, const std::string& csv) {
  const ordered_json all = ordered_json::parse(rtl::embedded_synthesis());
  Table table({"module", "LUT", "paper", "ratio", "registers", "paper", "ratio", "BRAM, kbit",
               "paper", "DSP", "MHz", "gates"});
  ordered_json json = json_of_program();
  json["table"] = "table1";
  json["rows"] = ordered_json::array();
  std::vector<std::string> reasons;
  OurRow sum;
  for (const PaperRow& paper : kPaper) {
    const OurRow ours = our_row(all, paper.module);
    sum = ours;
    const double lut_ratio = static_cast<double>(ours.lut) / paper.lut;
    const double register_ratio = static_cast<double>(ours.registers) / paper.registers;
    table.row({paper.module, with_commas(static_cast<unsigned>(ours.lut)),
               with_commas(static_cast<unsigned>(paper.lut)), fmt::format("{:.2f}", lut_ratio),
               with_commas(static_cast<unsigned>(ours.registers)),
               with_commas(static_cast<unsigned>(paper.registers)),
               fmt::format("{:.2f}", register_ratio), std::to_string(ours.bram_kbits),
               std::to_string(paper.bram_kbits), std::to_string(ours.dsp),
               fmt::format("{:.0f}", ours.mhz), fmt::format("{:.0f}", ours.gates)});
    std::string reason;
    if (std::max(far(ours.lut, paper.lut), far(ours.registers, paper.registers)) > kExplained) {
      reason = all["reasons"].value(paper.module, "");
      if (!reason.empty()) reasons.push_back(fmt::format("{}: {}", paper.module, reason));
    }
    json["rows"].push_back({{"module", paper.module},
                            {"lut", ours.lut},
                            {"paper_lut", paper.lut},
                            {"registers", ours.registers},
                            {"paper_registers", paper.registers},
                            {"bram_kbits", ours.bram_kbits},
                            {"paper_bram_kbits", paper.bram_kbits},
                            {"dsp", ours.dsp},
                            {"fmax_mhz", ours.mhz},
                            {"at_paper_clock", ours.mhz >= kPaperMhz},
                            {"gate_equivalents", ours.gates},
                            {"reason", reason}});
  }
  table.print(context.output);
  context.output.line("");
  for (const std::string& reason : reasons) context.output.line("{}", reason);
  const PaperRow& whole = std::end(kPaper)[-1];
  const bool within = sum.lut <= whole.lut && sum.registers <= whole.registers;
  context.output.line(
      "Yosys, xc7, unit by unit; MHz by a table of delays, without place and route, between "
      "registers (the paper: {:.0f}); gates: cells of a 180 nm library over its NAND2, no memories",
      kPaperMhz);
  context.output.line("the design is {} the paper's", within ? "smaller than" : "LARGER than");
  json["within_paper"] = within;
  if (!csv.empty()) {
    context.output.file(table.csv(), csv);
    context.output.line("written              {}", csv);
  }
  context.output.json(json, context.common.json);
  return within ? kDone : kCheckFailed;
}

}  // namespace fasttree::app
