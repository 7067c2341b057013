// SPDX-License-Identifier: Apache-2.0
// The numbers that define profile `realtime` (docs/realtime.md). The reference and the fast builder
// read them here; changing one changes every tree of the profile.
#pragma once

#include <cstdint>

#include "fasttree/build.h"
#include "fasttree/tree.h"

namespace fasttree {

struct RealtimeRule {
  /// k of the top grid: D0 is at most ceil(log2 N) + k, at least 0.
  int top_extra_depth = -2;
  /// The top grid has at most this many references a triangle.
  double top_growth = 3.0;

  /// A triangle whose box has more cells of the top grid than this is put only into those it
  /// overlaps.
  std::uint32_t large_cells = 64;

  /// A list of at most this many triangles is a leaf.
  std::uint32_t leaf_size = 160;
  /// A layer over n triangles has at most ceil(log2 n) + this many levels ...
  int layer_extra_depth = -3;
  /// ... and at most this many: its cells' counters have to stay in the first-level cache.
  int layer_most_depth = 9;
  /// A layer's boxes reach into at most this many cells a triangle ...
  std::uint32_t layer_growth = 2;
  /// ... and a tree has at most this many references for each of the top grid's.
  std::uint32_t whole_growth = 4;
  /// Layers above a leaf, the top grid not counted.
  int most_layers = 8;
  /// A layer is made where its cells' area times their triangles is less than this part of its
  /// box's area times its triangles.
  double worth = 0.9;
};

inline constexpr RealtimeRule kRealtimeRule;

/// What the paper's steps are asked for where they make the top grid.
inline BuildSettings top_grid_settings(const BuildSettings& settings) {
  BuildSettings top = settings;
  top.axes = AxisSchedule::longest;
  top.extra_depth = kRealtimeRule.top_extra_depth;
  top.max_growth = kRealtimeRule.top_growth;
  return top;
}

/// The tree has no grid of its own to tell of.
inline TreeInfo realtime_tree_info(const Box3& bounds, std::uint32_t triangle_count) {
  TreeInfo info;
  info.profile = Profile::realtime;
  info.axes = AxisSchedule::longest;
  info.triangle_count = triangle_count;
  info.bounds = bounds;
  return info;
}

}  // namespace fasttree
