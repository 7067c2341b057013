// SPDX-License-Identifier: Apache-2.0
#include "model/report/area.h"

#include <algorithm>
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

/// Lanes, and whatever else is there several times, in one row.
AreaReport area_of(const FastTree2Config& config) {
  const FastTree2Area blocks = fasttree2_area(config);
  // Bits that two blocks use in turn: the lines that the write combiner gathers lie in the lanes'
  // memories, the scene's prefetch in that of the records. They are taken off the former.
  const std::uint64_t lines =
      std::min(blocks.shared_bits, std::uint64_t{8} * config.buckets * config.combine_bytes);
  AreaReport report;
  for (std::size_t i = 0; i < blocks.blocks.size();) {
    const std::string kind = unit_stem(blocks.blocks[i].name);
    std::uint32_t count = 0;
    Resources sum;
    for (; i < blocks.blocks.size() && unit_stem(blocks.blocks[i].name) == kind; ++i, ++count) {
      const AreaBlock& block = blocks.blocks[i];
      sum += Resources{static_cast<double>(block.luts), static_cast<double>(block.registers),
                       static_cast<double>(block.sram_bits) / 1024};
    }
    if (kind == "write_combiner") sum.ram_kbits -= static_cast<double>(lines) / 1024;
    if (kind == "scene_reader") {
      sum.ram_kbits -= static_cast<double>(blocks.shared_bits - lines) / 1024;
    }
    report.add(kind, count, sum);
  }
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
  if (config.architecture == "fasttree-2") return area_of(config.fasttree2);
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
