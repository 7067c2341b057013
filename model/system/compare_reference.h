// SPDX-License-Identifier: Apache-2.0
// For tests: everything a run leaves in memory against the reference builder's arrays.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fasttree/device_image.h"
#include "model/config/paper_config.h"
#include "model/report/simulation.h"
#include "reference/reference_build.h"

namespace fasttree::model::test {

inline BuildSettings settings_of(const PaperConfig& config) {
  BuildSettings settings;
  settings.profile = Profile::paper;
  settings.axes = config.grid.axes;
  settings.depth = config.grid.depth_fixed ? static_cast<int>(config.grid.depth) : kAutoDepth;
  settings.extra_depth = static_cast<int>(config.grid.extra_depth);
  settings.max_growth = config.grid.max_growth;
  return settings;
}

/// The first array that differs and where, or empty.
inline std::string difference(const MeshView& mesh, const PaperConfig& config,
                              const SimulationResult& result) {
  BuildStats stats;
  const Result<reference::ReferenceBuild> built =
      reference::build(mesh, settings_of(config), stats);
  if (!built.ok()) return "reference: " + built.status().message();
  const reference::ReferenceBuild& b = built.value();
  const IntermediateArrays& a = result.arrays;
  std::string found;
  const auto compare = [&](const char* name, const std::vector<std::uint32_t>& ours,
                           const std::vector<std::uint32_t>& theirs) {
    if (!found.empty() || ours == theirs) return;
    std::size_t i = 0;
    while (i < ours.size() && i < theirs.size() && ours[i] == theirs[i]) ++i;
    found = std::string(name) + " differs at " + std::to_string(i) + " of " +
            std::to_string(ours.size()) + " and " + std::to_string(theirs.size());
  };
  compare("unsorted codes", a.unsorted_codes, b.references.codes);
  compare("unsorted ids", a.unsorted_ids, b.references.ids);
  compare("sorted codes", a.sorted_codes, b.sorted.codes);
  compare("sorted ids", a.sorted_ids, b.sorted.ids);
  compare("leaf codes", a.leaf_codes, b.leaves.code);
  compare("leaf first", a.leaf_first, b.leaves.first);
  compare("leaf count", a.leaf_count, b.leaves.count);
  compare("mark words", a.mark_words, b.essential.words());
  if (!found.empty()) return found;
  const DeviceImage image = reference::device_image(b);
  const Result<DeviceImage> ours = device_image_from_tree(result.tree);
  if (!ours.ok()) return ours.status().message();
  if (!(ours.value() == image)) return "device image differs";
  if (result.tree.hash() != tree_from_device_image(image).value().hash()) return "hash differs";
  return found;
}

}  // namespace fasttree::model::test
