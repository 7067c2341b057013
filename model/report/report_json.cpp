// SPDX-License-Identifier: Apache-2.0
#include "model/report/report_json.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "model/report/account.h"

namespace fasttree::model {
namespace {

using nlohmann::ordered_json;

ordered_json json_of(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json json_of(const UnitRecord& unit, const Activity& activity) {
  ordered_json on = ordered_json::object();
  for (const Wait& wait : waits(unit, activity)) on[wait.on] = wait.cycles;
  return {{"busy_cycles", activity.busy_cycles},
          {"stalled_cycles", activity.stalled()},
          {"idle_cycles", activity.idle_cycles},
          {"stalled_on_cycles", on}};
}

ordered_json stages_json(const SimulationResult& result) {
  ordered_json stages = ordered_json::array();
  for (const StageRecord& stage : result.stages) {
    const std::uint64_t cycles = cycles_of(stage);
    ordered_json traffic = ordered_json::array();
    for (const Traffic& t : stage.traffic) {
      traffic.push_back(
          {{"purpose", t.purpose}, {"read_bytes", t.read_bytes}, {"write_bytes", t.write_bytes}});
    }
    stages.push_back(
        {{"stage", stage.name},
         {"begin_cycle", stage.begin_cycle},
         {"cycles", cycles},
         {"read_bytes", read_bytes(stage)},
         {"write_bytes", write_bytes(stage)},
         {"bandwidth_gb_s", gb_per_s(result, read_bytes(stage) + write_bytes(stage), cycles)},
         {"traffic", traffic}});
  }
  return stages;
}

ordered_json units_json(const SimulationResult& result) {
  ordered_json units = ordered_json::array();
  for (const UnitRecord& unit : result.units) {
    ordered_json entry = {{"unit", unit.name}, {"kind", unit.kind}};
    entry.update(json_of(unit, whole_run(unit)));
    ordered_json stages = ordered_json::array();
    for (std::size_t s = 0; s < unit.by_stage.size(); ++s) {
      ordered_json stage = {{"stage", result.stages[s].name}};
      stage.update(json_of(unit, unit.by_stage[s]));
      stages.push_back(std::move(stage));
    }
    entry["stages"] = std::move(stages);
    units.push_back(std::move(entry));
  }
  return units;
}

ordered_json memory_json(const SimulationReport& report) {
  const SimulationResult& result = report.result;
  const MemoryStatistics& m = result.memory;
  const double bandwidth = gb_per_s(result, m.read_bytes + m.write_bytes, result.cycles);
  const double peak = result.memory_traits.peak_gb_s;
  return {{"name", result.memory_traits.name},
          {"channels", result.memory_traits.channels},
          {"access_bytes", result.memory_traits.access_bytes},
          {"peak_gb_s", peak > 0 ? ordered_json(peak) : ordered_json(nullptr)},
          {"bus_peak_gb_s", json_of(bus_peak_gb_s(report.config))},
          {"bandwidth_gb_s", bandwidth},
          {"bandwidth_share", peak > 0 ? ordered_json(bandwidth / peak) : ordered_json(nullptr)},
          {"read_bytes", m.read_bytes},
          {"write_bytes", m.write_bytes},
          {"reads", m.reads},
          {"writes", m.writes},
          {"row_hits", m.row_hits},
          {"row_misses", m.row_misses},
          {"row_conflicts", m.row_conflicts},
          {"row_hit_share", json_of(row_hit_share(m))},
          {"refreshes", m.refreshes},
          {"turnarounds", m.turnarounds},
          {"read_latency_mean_ns",
           m.reads > 0 ? ordered_json(mean_read_latency_ns(m)) : ordered_json(nullptr)},
          {"read_latency_median_ns", json_of(read_latency_percentile_ns(m, 0.5))},
          {"read_latency_99_percent_ns", json_of(read_latency_percentile_ns(m, 0.99))},
          {"read_latency_bucket_ns", 8},
          {"read_latency_histogram", m.read_latency_8ns}};
}

ordered_json cache_json(const CacheStatistics& cache) {
  const std::uint64_t accesses = cache.reads + cache.writes;
  const std::uint64_t hits = cache.read_hits + cache.write_hits;
  return {{"reads", cache.reads},
          {"read_hits", cache.read_hits},
          {"writes", cache.writes},
          {"write_hits", cache.write_hits},
          {"write_backs", cache.write_backs},
          {"hit_share",
           accesses > 0 ? ordered_json(static_cast<double>(hits) / static_cast<double>(accesses))
                        : ordered_json(nullptr)}};
}

ordered_json costs_json(const std::vector<CostTable>& costs) {
  ordered_json tables = ordered_json::object();
  for (const CostTable& table : costs) {
    ordered_json total = ordered_json::object();
    ordered_json rows = ordered_json::array();
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      total[table.columns[c].key] = table.total(c);
    }
    for (const CostTable::Row& row : table.rows) {
      ordered_json entry = {{"unit", row.unit}};
      for (std::size_t c = 0; c < table.columns.size(); ++c) {
        entry[table.columns[c].key] = row.values[c];
      }
      rows.push_back(std::move(entry));
    }
    for (const CostTable::Figure& figure : table.figures) total[figure.key] = figure.value;
    tables[table.key] = {{"total", total}, {"units", rows}, {"basis", table.basis}};
  }
  return tables;
}

}  // namespace

ordered_json report_json(const SimulationReport& report) {
  const SimulationResult& result = report.result;
  ordered_json json;
  json["scene"] = report.scene;
  json["config"] = result.config;
  json["engine"] = report.engine;
  json["architecture"] = report.config.architecture;
  json["clock_mhz"] = result.clock_mhz;
  json["triangles"] = result.triangles;
  json["references"] = result.references;
  json["leaves"] = result.leaves;
  json["depth"] = result.tree.info().depth;
  json["axes"] = to_string(result.tree.info().axes);
  json["cycles"] = result.cycles;
  json["cycles_per_triangle"] = cycles_per_triangle(result);
  json["time_ms"] = result.time_ms();
  json["frames_per_s"] = frames_per_s(result);
  json["tree_hash"] = hash_string(result.tree.hash());
  json["compared"] = report.compared;
  json["difference"] =
      report.difference.empty() ? ordered_json(nullptr) : ordered_json(report.difference);
  json["stages"] = stages_json(result);
  json["units"] = units_json(result);
  json["memory"] = memory_json(report);
  json["mark_cache"] = cache_json(result.mark_cache);
  json.update(costs_json(report.costs));
  json["simulation_s"] = report.wall_s;
  json["simulation_cycles_per_s"] =
      report.wall_s > 0 ? static_cast<double>(result.cycles) / report.wall_s : 0.0;
  return json;
}

}  // namespace fasttree::model
