// SPDX-License-Identifier: Apache-2.0
#include "effects.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fasttree::app {
namespace {

double mean(const std::vector<const ExploredRun*>& runs, double ExploredRun::*member) {
  if (runs.size() == 1) return runs.front()->*member;  // to the last digit
  double sum = 0;
  for (const ExploredRun* run : runs) sum += std::log(std::max(run->*member, 1e-300));
  return std::exp(sum / static_cast<double>(runs.size()));
}

double percent(double value, double base) {
  return base > 0 ? (value / base - 1) * 100 : 0;
}

}  // namespace

std::vector<Summary> summaries(const std::vector<DesignPoint>& points, std::size_t scenes,
                               const std::vector<ExploredRun>& runs) {
  std::vector<Summary> list;
  for (std::size_t p = 0; p < points.size(); ++p) {
    Summary s;
    s.point = &points[p];
    s.done = true;
    for (std::size_t i = 0; i < scenes; ++i) {
      const ExploredRun& run = runs[p * scenes + i];
      s.runs.push_back(&run);
      s.done = s.done && run.done();
    }
    if (s.done) {
      s.time_ms = mean(s.runs, &ExploredRun::time_ms);
      s.cycles_per_triangle = mean(s.runs, &ExploredRun::cycles_per_triangle);
      s.area_mm2 = s.runs.front()->area_65nm_mm2;  // of the machine, not of the scene
      s.energy_uj = mean(s.runs, &ExploredRun::energy_uj);
    }
    list.push_back(std::move(s));
  }
  return list;
}

std::vector<Effect> effects_of(const std::vector<Summary>& list) {
  std::vector<Effect> effects;
  const Summary& base = list.front();
  if (!base.done) return effects;
  for (std::size_t i = 1; i < list.size(); ++i) {
    const Summary& s = list[i];
    if (!s.done) continue;
    Effect effect;
    effect.changed = &s;
    for (std::size_t r = 0; r < s.runs.size(); ++r) {
      effect.time_percent.push_back(percent(s.runs[r]->time_ms, base.runs[r]->time_ms));
    }
    effect.mean_time_percent = percent(s.time_ms, base.time_ms);
    effect.area_percent = percent(s.area_mm2, base.area_mm2);
    effect.energy_percent = percent(s.energy_uj, base.energy_uj);
    effects.push_back(std::move(effect));
  }
  std::stable_sort(effects.begin(), effects.end(), [](const Effect& a, const Effect& b) {
    return std::abs(a.mean_time_percent) > std::abs(b.mean_time_percent);
  });
  return effects;
}

}  // namespace fasttree::app
