// SPDX-License-Identifier: Apache-2.0
// What design points come to over all scenes, and what one change of a key is worth.
#pragma once

#include <cstddef>
#include <vector>

#include "design_points.h"
#include "exploration.h"

namespace fasttree::app {

/// A point over all scenes: geometric means, so that no scene outweighs the others.
struct Summary {
  const DesignPoint* point = nullptr;
  std::vector<const ExploredRun*> runs;  ///< a scene
  bool done = false;                     ///< on all scenes
  double time_ms = 0, cycles_per_triangle = 0, area_mm2 = 0, energy_uj = 0;
  bool front_area = false, front_energy = false;
};

/// A point after the other, of runs as explore() gives them. Refers to both.
std::vector<Summary> summaries(const std::vector<DesignPoint>& points, std::size_t scenes,
                               const std::vector<ExploredRun>& runs);

/// What one change from the base is worth, in per cent.
struct Effect {
  const Summary* changed = nullptr;
  std::vector<double> time_percent;  ///< a scene
  double mean_time_percent = 0, area_percent = 0, energy_percent = 0;
};

/// Of all points over the first one, without those that a machine refuses; the largest first.
/// Refers to the list.
std::vector<Effect> effects_of(const std::vector<Summary>& list);

}  // namespace fasttree::app
