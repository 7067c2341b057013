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
#include "paper_tables.h"
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
constexpr double kExplained = 0.25;  // differences over this have a reason

double far(double ours, double paper) {
  return paper > 0 ? std::abs(ours / paper - 1) : 0;
}

/// What synthesis gave for a row's modules, together.
ModuleResources our_row(const ordered_json& all, const std::string& row) {
  ModuleResources sum;
  sum.module = row;
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

std::vector<ModuleResources> reproduce_table1() {
  const ordered_json all = ordered_json::parse(rtl::embedded_synthesis());
  std::vector<ModuleResources> rows;
  for (const PaperRow& paper : kPaper) {
    ModuleResources row = our_row(all, paper.module);
    row.paper_lut = paper.lut;
    row.paper_registers = paper.registers;
    row.paper_bram_kbits = paper.bram_kbits;
    if (std::max(far(row.lut, paper.lut), far(row.registers, paper.registers)) > kExplained) {
      row.reason = all["reasons"].value(paper.module, "");
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Table table_of(const std::vector<ModuleResources>& rows, bool reasons) {
  const auto count = [](int n) { return with_commas(static_cast<unsigned>(n)); };
  // Short on a terminal; in a file each column has a name of its own.
  Table table(
      reasons ? std::vector<std::string>{"module", "LUT", "LUT, paper", "LUT ratio", "registers",
                                         "registers, paper", "register ratio", "BRAM, kbit",
                                         "BRAM, paper", "DSP", "MHz", "gates", "reason"}
              : std::vector<std::string>{"module", "LUT", "paper", "ratio", "registers", "paper",
                                         "ratio", "BRAM, kbit", "paper", "DSP", "MHz", "gates"});
  for (const ModuleResources& row : rows) {
    std::vector<std::string> cells = {row.module,
                                      count(row.lut),
                                      count(row.paper_lut),
                                      fmt::format("{:.2f}", row.lut_ratio()),
                                      count(row.registers),
                                      count(row.paper_registers),
                                      fmt::format("{:.2f}", row.register_ratio()),
                                      std::to_string(row.bram_kbits),
                                      std::to_string(row.paper_bram_kbits),
                                      std::to_string(row.dsp),
                                      fmt::format("{:.0f}", row.mhz),
                                      fmt::format("{:.0f}", row.gates)};
    if (reasons) cells.push_back(row.reason);
    table.row(std::move(cells));
  }
  return table;
}

ordered_json json_of(const ModuleResources& row) {
  return {{"module", row.module},
          {"lut", row.lut},
          {"paper_lut", row.paper_lut},
          {"registers", row.registers},
          {"paper_registers", row.paper_registers},
          {"bram_kbits", row.bram_kbits},
          {"paper_bram_kbits", row.paper_bram_kbits},
          {"dsp", row.dsp},
          {"fmax_mhz", row.mhz},
          {"at_paper_clock", row.mhz >= kPaperFpgaMhz},
          {"gate_equivalents", row.gates},
          {"reason", row.reason}};
}

const char* table1_basis() {
  return "Yosys, xc7, unit by unit; MHz by a table of delays, without place and route, between "
         "registers (the paper: 163); gates: cells of a 180 nm library over its NAND2, no memories";
}

bool within_paper(const std::vector<ModuleResources>& rows) {
  const ModuleResources& whole = rows.back();
  return whole.lut <= whole.paper_lut && whole.registers <= whole.paper_registers;
}

int report_table1(Context& context, const std::string& csv) {
  const std::vector<ModuleResources> rows = reproduce_table1();
  const bool within = within_paper(rows);
  const Table table = table_of(rows, false);
  table.print(context.output);
  context.output.line("");
  for (const ModuleResources& row : rows) {
    if (!row.reason.empty()) context.output.line("{}: {}", row.module, row.reason);
  }
  context.output.line("{}", table1_basis());
  context.output.line("the design is {} the paper's", within ? "smaller than" : "LARGER than");
  ordered_json json = json_of_program();
  json["table"] = "table1";
  json["rows"] = ordered_json::array();
  for (const ModuleResources& row : rows) json["rows"].push_back(json_of(row));
  json["within_paper"] = within;
  if (!csv.empty()) {
    context.output.file(table.csv(), csv);
    context.output.line("written              {}", csv);
  }
  context.output.json(json, context.common.json);
  return within ? kDone : kCheckFailed;
}

}  // namespace fasttree::app
