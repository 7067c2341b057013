// SPDX-License-Identifier: Apache-2.0
#include "model/report/area.h"

#include <utility>

#include "model/fasttree2/area.h"
#include "model/report/paper_area.h"

namespace fasttree::model {
namespace {

constexpr double kGatesPerLut = 6;
constexpr double kGatesPerRegister = 6;
constexpr double kGatesPerRamBit = 0.7;

// Section IV.B and V.B of the paper; the second one is a bound ("at most").
constexpr double kPaperMm2At65nm = 5.4;
constexpr double kPaperMm2At28nm = 1.4;

/// Lanes, and whatever else is there several times, in one row; bits that two blocks share are
/// taken off the block that shares them out.
AreaReport area_of(const FastTree2Area& blocks) {
  struct Row {
    std::string kind;
    std::uint32_t count = 0;
    Resources resources;
  };
  std::vector<Row> rows;
  for (const AreaBlock& block : blocks.blocks) {
    const std::string kind = unit_stem(block.name);
    if (rows.empty() || rows.back().kind != kind) rows.push_back({kind, 0, {}});
    ++rows.back().count;
    rows.back().resources +=
        Resources{static_cast<double>(block.luts), static_cast<double>(block.registers),
                  static_cast<double>(block.sram_bits) / 1024};
  }
  AreaReport report;
  for (Row& row : rows) report.add(std::move(row.kind), row.count, row.resources);
  report.add("memory used twice", 1, {0, 0, -static_cast<double>(blocks.shared_bits) / 1024});
  return report;
}

}  // namespace

double gates_of(const Resources& r) {
  return kGatesPerLut * r.luts + kGatesPerRegister * r.registers +
         kGatesPerRamBit * 1024 * r.ram_kbits;
}

double mm2_of(const Resources& resources, Process process) {
  const double share = gates_of(resources) / gates_of(paper_area_total());
  return share * (process == Process::nm65 ? kPaperMm2At65nm : kPaperMm2At28nm);
}

void AreaReport::add(std::string kind, std::uint32_t count, const Resources& resources) {
  AreaRow& row = rows.emplace_back();
  row.kind = std::move(kind);
  row.count = count;
  row.resources = resources;
  row.mm2_65nm = mm2_of(resources, Process::nm65);
  row.mm2_28nm = mm2_of(resources, Process::nm28);
  total += resources;
  mm2_65nm += row.mm2_65nm;
  mm2_28nm += row.mm2_28nm;
}

std::string unit_stem(const std::string& name) {
  return name.substr(0, name.find_last_not_of("0123456789") + 1);
}

AreaReport area(const MachineConfig& config) {
  if (config.architecture == "fasttree-2") return area_of(fasttree2_area(config.fasttree2));
  AreaReport report;
  for (const PaperAreaRow& row : paper_area_rows(config.paper)) {
    report.add(row.kind, row.count, row.counted + row.rest);
  }
  return report;
}

const char* area_basis() {
  return "counted structure, calibrated on the paper's Table I and its totals (5.4 mm2 at 65 nm, "
         "at "
         "most 1.4 mm2 at 28 nm) and on nothing else: an estimate, not a synthesis";
}

}  // namespace fasttree::model
