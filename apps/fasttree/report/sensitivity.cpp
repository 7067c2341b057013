// SPDX-License-Identifier: Apache-2.0
#include "report/sensitivity.h"

#include "effects.h"
#include "progress.h"

namespace fasttree::app {
namespace {

/// Beside what assumptions() takes. The clocks are half the paper's and its fastest.
std::vector<Variation> more_variations(const DesignPoint& machine) {
  std::vector<Variation> list = {
      {"clock_mhz", {"250", "720"}},        {"memory.cl_clocks", {"6", "24"}},
      {"memory.trcd_clocks", {"8", "30"}},  {"memory.trp_clocks", {"8", "30"}},
      {"memory.tfaw_clocks", {"20", "80"}}, {"memory.channels", {"1", "4"}}};
  if (machine.config.architecture == "paper") {
    const std::vector<Variation> units = {{"paper.mark_cache_bytes", {"8192", "32768"}},
                                          {"paper.mark_cache_ways", {"8", "32"}},
                                          {"paper.morton_code_units", {"2", "8"}},
                                          {"paper.prefix_sum_units", {"2", "8"}},
                                          {"paper.prefix_sum_stages", {"4", "8"}},
                                          {"paper.radix_sort_radix_bits", {"2", "8"}},
                                          {"paper.radix_sort_sorted_bits", {"24"}},
                                          {"paper.internal_node_plane_cycles", {"4"}},
                                          {"paper.internal_node_shifts_per_cycle", {"32"}}};
    list.insert(list.end(), units.begin(), units.end());
  }
  return list;
}

}  // namespace

Sensitivity sensitivity_of(Context& context, const DesignPoint& machine,
                           const std::vector<ExploredScene>& scene, std::uint64_t memory_bytes) {
  std::vector<Variation> variations = assumptions(machine.config);
  const std::vector<Variation> more = more_variations(machine);
  variations.insert(variations.end(), more.begin(), more.end());
  const std::vector<DesignPoint> points = single_points(machine.config, variations);
  ResultsFile nowhere("");
  const Exploration made = explore(context, points, scene, nowhere, memory_bytes);
  context.progress.clear();
  if (made.cancelled) throw Failure{kCancelled, "cancelled"};

  Sensitivity result;
  result.config = machine.config.name;
  result.scene = scene.front().scene.mesh.name;
  const std::vector<Summary> list = summaries(points, scene.size(), made.runs);
  result.base = *list.front().runs.front();
  for (const Effect& effect : effects_of(list)) {
    const std::string& change = effect.changed->point->changes.front();
    const std::size_t equals = change.find('=');
    const KeyInfo info = key_info(machine.config, change.substr(0, equals));
    result.changes.push_back({change.substr(0, equals), info.value, change.substr(equals + 1),
                              info.comment, effect.mean_time_percent, effect.area_percent,
                              effect.energy_percent});
  }
  for (const ExploredRun& run : made.runs) {
    if (!run.done()) result.refused.push_back(run.changes + ": " + run.status);
  }
  return result;
}

}  // namespace fasttree::app
