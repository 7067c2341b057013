// SPDX-License-Identifier: Apache-2.0
// What the fast tracer walks: nodes of 16 children made from a kd-tree's leaves, and the leaves'
// triangles as structures of arrays. Docs: docs/tracing.md.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "fasttree/mesh.h"
#include "fasttree/tree.h"
#include "support/raw_array.h"

namespace fasttree {

inline constexpr std::uint32_t kWide = 16;

/// Several levels of the kd-tree in one. A child's box is that of what it lists, cut by its cell,
/// so empty space needs no nodes. Coordinates are relative to WideLayout::centre.
struct alignas(64) WideNode {
  float bound[2][3][kWide];    ///< [lower, upper][axis][child]; no child: infinite, upside down
  std::uint32_t child[kWide];  ///< inner: index of the node; leaf: first reference
  std::uint8_t count[kWide];   ///< leaf: triangles, at most kMostInLeaf; inner: 0
  /// Children from front to back, a nibble each, the first lowest, for rays that go down none of
  /// the axes, down x, down y, down x and y, and up z. For rays down z: the opposite one,
  /// backwards.
  std::uint64_t order[4];
  std::array<std::uint8_t, 16> unused;
};
static_assert(sizeof(WideNode) == 512);

/// More triangles in a leaf of the kd-tree become several children, in the order of their ids.
inline constexpr std::uint32_t kMostInLeaf = 240;

/// Most nodes on the way to a leaf: those of the kd-tree, and those over the parts of a large leaf.
inline constexpr std::uint32_t kMostWideLevels = kMaxTreeDepth + 8;

/// Rows of a leaf's triangles: three corners of three coordinates.
inline constexpr std::uint32_t kTriangleRows = 9;

struct WideLayout {
  Vec3 centre{};             ///< of the scene's bounds
  RawArray<WideNode> nodes;  ///< room for more than there are; the root is the first
  std::uint32_t node_count = 0;
  /// Reference r of a leaf that begins at `first` with n triangles has its coordinate c at
  /// kTriangleRows * first + c * n + (r - first). Whole vectors may be read at the end.
  RawArray<float> triangles;
  std::span<const std::uint32_t> ids;  ///< the tree's: of reference r

  const float* triangles_of(std::uint32_t first) const {
    return triangles.data() + std::size_t{kTriangleRows} * first;
  }
  std::uint64_t bytes() const {
    return node_count * sizeof(WideNode) + triangles.size() * sizeof(float);
  }
};

/// Makes the layout in the layout's memory, on the threads of the calling arena. `tree` and `mesh`
/// belong together. Where nodes lie depends on which thread came first; nothing that can be seen
/// from outside does.
void make_wide_layout(const Tree& tree, const MeshView& mesh, WideLayout& layout);

}  // namespace fasttree
