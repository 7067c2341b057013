// SPDX-License-Identifier: Apache-2.0
// Profile `paper`, fast: the six steps on all threads of the calling arena. Same bytes as
// src/reference, which says what each step means.
#pragma once

#include <cstdint>
#include <vector>

#include "build/buckets.h"
#include "build/triangle_boxes.h"
#include "build/vertex_codes.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/tree.h"

namespace fasttree::build {

/// Working memory kept from build to build.
struct Workspace {
  /// Vertices outside the bounds of the last mesh, which no triangle used, ascending; none where
  /// they are too many. The next mesh is first tried without them.
  Buffer<std::uint32_t> strays;
  Buffer<std::uint32_t> vertex_codes;
  Buffer<CodeBox> boxes;
  Buckets buckets;
  std::vector<std::uint32_t> first_node_of_bucket;
};

/// The arrays of a tree in the making.
struct TreeArrays {
  TreeInfo info;
  std::vector<Node> nodes;
  std::vector<std::uint32_t> ids;
};

/// Builds into `tree`, whose arrays' memory is reused. Errors as Builder::build.
Status morton_build(const MeshView& mesh, const BuildSettings& settings, Workspace& workspace,
                    TreeArrays& tree, BuildStats& stats);

}  // namespace fasttree::build
