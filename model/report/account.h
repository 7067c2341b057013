// SPDX-License-Identifier: Apache-2.0
// Figures that follow from a run's account: sums over stages, shares, rates, percentiles.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/config/machine_config.h"
#include "model/report/simulation.h"

namespace fasttree::model {

inline std::uint64_t cycles_of(const StageRecord& stage) {
  return stage.end_cycle - stage.begin_cycle;
}
inline std::uint64_t cycles_of(const Activity& activity) {
  return activity.busy_cycles + activity.stalled() + activity.idle_cycles;
}

/// A unit's cycles over all stages.
Activity whole_run(const UnitRecord& unit);

/// Cycles for which a unit waited for somebody.
struct Wait {
  std::string on;
  std::uint64_t cycles = 0;
};
/// Those that were, the longest first.
std::vector<Wait> waits(const UnitRecord& unit, const Activity& activity);

/// Bytes over the bus in a stage, or in all of them by purpose.
std::uint64_t read_bytes(const StageRecord& stage);
std::uint64_t write_bytes(const StageRecord& stage);
std::uint64_t read_bytes(const SimulationResult& result);
std::uint64_t write_bytes(const SimulationResult& result);

double cycles_per_triangle(const SimulationResult& result);  ///< 0 without triangles
double frames_per_s(const SimulationResult& result);         ///< 0 without cycles

/// 10^9 bytes a second, at the machine's clock.
double gb_per_s(const SimulationResult& result, std::uint64_t bytes, std::uint64_t cycles);

/// What the machine's own bus can move at most, in 10^9 bytes a second; nothing where the machine
/// has none beside the memory's.
std::optional<double> bus_peak_gb_s(const MachineConfig& config);

/// Of the accesses to DRAM, those that found their row open; nothing where there are no rows.
std::optional<double> row_hit_share(const MemoryStatistics& memory);

double mean_read_latency_ns(const MemoryStatistics& memory);  ///< 0 without reads

/// The latency that `share` of the reads do not exceed, as the upper end of its bucket of 8 ns.
/// Nothing without reads, and where it lies in the last bucket, which has no end.
std::optional<double> read_latency_percentile_ns(const MemoryStatistics& memory, double share);

}  // namespace fasttree::model
