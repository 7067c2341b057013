// SPDX-License-Identifier: Apache-2.0
// Profile `paper`, fast: the six steps on all threads of the calling arena. Same bytes as
// src/reference, which says what each step means.
#pragma once

#include <cstdint>
#include <vector>

#include "build/triangle_block.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/tree.h"

namespace fasttree::build {

/// Working memory kept from build to build.
struct Workspace {
  std::vector<StoredBox> boxes;                 ///< per triangle
  std::vector<std::uint64_t> block_references;  ///< per block of kBlock triangles
  std::vector<std::uint32_t> codes[2];          ///< per reference, back and forth in the sort
  std::vector<std::uint32_t> ids;               ///< per reference, the sort's second buffer
  std::vector<std::uint32_t> sort_counters;
  std::vector<std::uint64_t> chunk_leaves;
  std::vector<std::uint32_t> leaf_codes;
  std::vector<std::uint32_t> leaf_first;
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
