// SPDX-License-Identifier: Apache-2.0
#include "model/report/energy.h"

#include <algorithm>

#include "model/report/paper_area.h"

namespace fasttree::model {
namespace {

// Section IV.B and V.B of the paper, at its 500 MHz; the second one is a bound.
constexpr double kPaperWattsAt65nm = 3.9;
constexpr double kPaperWattsAt28nm = 0.8;
constexpr double kPaperMhz = 500;

/// Energy of one cycle in which so much area works.
double pj_per_cycle(const Resources& resources, double paper_watts) {
  const double share = gates_of(resources) / gates_of(paper_area_total());
  return share * paper_watts / kPaperMhz * 1e6;  // W / MHz = uJ
}

/// Share of the run in which the units of a row work, on average. What has no account of its own
/// (the control) always does.
double busy_share(const std::string& kind, const SimulationResult& result) {
  std::uint64_t busy = 0, units = 0;
  const bool named = std::any_of(result.units.begin(), result.units.end(),
                                 [&](const auto& unit) { return unit_stem(unit.name) == kind; });
  for (const UnitRecord& unit : result.units) {
    if ((named ? unit_stem(unit.name) : unit.kind) != kind) continue;
    ++units;
    for (const Activity& activity : unit.by_stage) busy += activity.busy_cycles;
  }
  if (units == 0) return 1;
  if (result.cycles == 0) return 0;
  const double all = static_cast<double>(result.cycles) * static_cast<double>(units);
  return std::min(1.0, static_cast<double>(busy) / all);
}

/// Typical figures of such devices; the paper says nothing of its memory's energy.
struct DramEnergy {
  double pj_per_byte;
  double pj_per_activation;
};
constexpr DramEnergy kLpddr3{40, 2000};  // 1.2 V, one channel of x32
constexpr DramEnergy kDdr3{130, 12000};  // 1.5 V, eight chips of x8 with termination

}  // namespace

EnergyReport energy(const MachineConfig& config, const SimulationResult& result) {
  EnergyReport report;
  const double cycles = static_cast<double>(result.cycles);
  for (const AreaRow& row : area(config).rows) {
    const double all = cycles * pj_per_cycle(row.resources, kPaperWattsAt65nm);
    const double busy = busy_share(row.kind, result);
    report.rows.push_back({row.kind, busy * all, (1 - busy) * kIdleShare * all});
    report.machine_pj += report.rows.back().busy_pj + report.rows.back().idle_pj;
  }
  report.machine_28nm_pj = report.machine_pj * (kPaperWattsAt28nm / kPaperWattsAt65nm);
  if (config.memory.kind == MemoryKind::dram) {
    const bool ddr3 = config.memory.preset.rfind("ddr3", 0) == 0;
    const DramEnergy& dram = ddr3 ? kDdr3 : kLpddr3;
    const MemoryStatistics& m = result.memory;
    // A short access still moves a whole burst.
    const std::uint64_t bytes = (m.reads + m.writes) * result.memory_traits.access_bytes;
    const std::uint64_t rows = m.row_misses + m.row_conflicts;
    report.memory_rows.push_back(
        {"bytes moved", bytes, dram.pj_per_byte * static_cast<double>(bytes)});
    report.memory_rows.push_back(
        {"rows activated", rows, dram.pj_per_activation * static_cast<double>(rows)});
    for (const MemoryEnergyRow& row : report.memory_rows) report.memory_pj += row.pj;
  }
  const double seconds = result.time_ms() / 1e3;
  if (seconds > 0) {
    report.machine_power_w = report.machine_pj * 1e-12 / seconds;
    report.machine_28nm_power_w = report.machine_28nm_pj * 1e-12 / seconds;
  }
  if (result.triangles > 0) {
    report.pj_per_triangle =
        (report.machine_pj + report.memory_pj) / static_cast<double>(result.triangles);
  }
  return report;
}

const char* energy_basis() {
  return "shared out by area from the paper's 3.9 W at 500 MHz in 65 nm (at most 0.8 W in 28 nm) "
         "with "
         "everything busy; idle cycles assumed at 30 per cent; memory by typical figures of such "
         "devices, of which the paper says nothing: an estimate, not a measurement";
}

}  // namespace fasttree::model
