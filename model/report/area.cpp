// SPDX-License-Identifier: Apache-2.0
#include "model/report/area.h"

#include <utility>

#include "model/report/paper_area.h"

namespace fasttree::model {
namespace {

constexpr double kGatesPerLut = 6;
constexpr double kGatesPerRegister = 6;
constexpr double kGatesPerRamBit = 0.7;

// Section IV.B and V.B of the paper; the second one is a bound ("at most").
constexpr double kPaperMm2At65nm = 5.4;
constexpr double kPaperMm2At28nm = 1.4;

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

AreaReport area(const MachineConfig& config) {
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
