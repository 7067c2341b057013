// SPDX-License-Identifier: Apache-2.0
#include "model/report/account.h"

#include <algorithm>

namespace fasttree::model {

Activity whole_run(const UnitRecord& unit) {
  Activity sum;
  sum.stalled_cycles.resize(unit.stall_reasons.size());
  for (const Activity& activity : unit.by_stage) {
    sum.busy_cycles += activity.busy_cycles;
    sum.idle_cycles += activity.idle_cycles;
    for (std::size_t r = 0; r < activity.stalled_cycles.size(); ++r) {
      sum.stalled_cycles[r] += activity.stalled_cycles[r];
    }
  }
  return sum;
}

std::vector<Wait> waits(const UnitRecord& unit, const Activity& activity) {
  std::vector<Wait> list;
  for (std::size_t r = 0; r < activity.stalled_cycles.size(); ++r) {
    if (activity.stalled_cycles[r] == 0) continue;
    list.push_back({unit.stall_reasons[r], activity.stalled_cycles[r]});
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const Wait& a, const Wait& b) { return a.cycles > b.cycles; });
  return list;
}

std::uint64_t read_bytes(const StageRecord& stage) {
  std::uint64_t sum = 0;
  for (const Traffic& traffic : stage.traffic) sum += traffic.read_bytes;
  return sum;
}

std::uint64_t write_bytes(const StageRecord& stage) {
  std::uint64_t sum = 0;
  for (const Traffic& traffic : stage.traffic) sum += traffic.write_bytes;
  return sum;
}

std::uint64_t read_bytes(const SimulationResult& result) {
  std::uint64_t sum = 0;
  for (const StageRecord& stage : result.stages) sum += read_bytes(stage);
  return sum;
}

std::uint64_t write_bytes(const SimulationResult& result) {
  std::uint64_t sum = 0;
  for (const StageRecord& stage : result.stages) sum += write_bytes(stage);
  return sum;
}

double cycles_per_triangle(const SimulationResult& result) {
  if (result.triangles == 0) return 0;
  return static_cast<double>(result.cycles) / static_cast<double>(result.triangles);
}

double frames_per_s(const SimulationResult& result) {
  const double ms = result.time_ms();
  return ms > 0 ? 1000 / ms : 0;
}

double gb_per_s(const SimulationResult& result, std::uint64_t bytes, std::uint64_t cycles) {
  if (cycles == 0) return 0;
  return static_cast<double>(bytes) * result.clock_mhz / static_cast<double>(cycles) / 1000;
}

std::optional<double> bus_peak_gb_s(const MachineConfig& config) {
  if (config.architecture != "paper") return std::nullopt;
  const double ways = config.paper.bus.duplex ? 2 : 1;
  return ways * config.paper.bus.bytes * config.clock_mhz / 1000;
}

std::optional<double> row_hit_share(const MemoryStatistics& memory) {
  const std::uint64_t all = memory.row_hits + memory.row_misses + memory.row_conflicts;
  if (all == 0) return std::nullopt;
  return static_cast<double>(memory.row_hits) / static_cast<double>(all);
}

double mean_read_latency_ns(const MemoryStatistics& memory) {
  return memory.reads > 0 ? memory.read_latency_sum_ns / static_cast<double>(memory.reads) : 0;
}

std::optional<double> read_latency_percentile_ns(const MemoryStatistics& memory, double share) {
  std::uint64_t all = 0;
  for (const std::uint64_t reads : memory.read_latency_8ns) all += reads;
  if (all == 0) return std::nullopt;
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i + 1 < memory.read_latency_8ns.size(); ++i) {
    seen += memory.read_latency_8ns[i];
    if (static_cast<double>(seen) >= share * static_cast<double>(all)) {
      return 8.0 * static_cast<double>(i + 1);
    }
  }
  return std::nullopt;
}

}  // namespace fasttree::model
