// SPDX-License-Identifier: Apache-2.0
// Profile `paper`, fast: the six steps on all threads of the calling arena. Same bytes as
// src/reference, which says what each step means.
#pragma once

#include <cstdint>
#include <vector>

#include "build/buckets.h"
#include "build/buffer.h"
#include "build/layers.h"
#include "build/triangle_boxes.h"
#include "build/vertex_codes.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/tree.h"
#include "grid/grid.h"
#include "support/stage_clock.h"

namespace fasttree::build {

/// Working memory kept from build to build.
struct Workspace {
  /// Vertices outside the bounds of the last mesh, which no triangle used, ascending; none where
  /// they are too many. The next mesh is first tried without them.
  Buffer<std::uint32_t> strays;
  Buffer<std::uint32_t> vertex_codes;
  Buffer<CodeBox> boxes;
  Buckets buckets;
  Buffer<std::uint32_t> first_node_of_bucket;
  Buffer<std::uint32_t> top_ids;  ///< profile realtime: of the top grid
  Layers layers;
};

/// The arrays of a tree in the making, which a Tree then keeps and shows.
struct TreeArrays {
  TreeInfo info;
  Buffer<Node> nodes;
  Buffer<std::uint32_t> ids;
};

/// What the grid's cells hold, sorted; the cells themselves are in the workspace's buckets.
struct SortedLeaves {
  Grid grid;
  BucketGrid buckets{CodeAxes()};
  std::uint64_t references = 0;
};

/// Steps 1 to 4, which take a `share` of the whole build's progress. `more_bytes_per_reference` is
/// what the caller is going to take beside. Errors as Builder::build.
Status sort_into_leaves(const MeshView& mesh, const BuildSettings& settings,
                        std::uint64_t more_bytes_per_reference, double share, StageClock& clock,
                        Workspace& workspace, Buffer<std::uint32_t>& ids, BuildStats& stats,
                        SortedLeaves& sorted);

/// Builds into `tree`, whose arrays' memory is reused. Errors as Builder::build.
Status morton_build(const MeshView& mesh, const BuildSettings& settings, Workspace& workspace,
                    TreeArrays& tree, BuildStats& stats);

}  // namespace fasttree::build
