// SPDX-License-Identifier: Apache-2.0
// Is this a good tree? Names the first invariant that is broken.
#pragma once

#include <cstdint>
#include <string>

#include "fasttree/mesh.h"
#include "fasttree/tree.h"

namespace fasttree {

/// The first broken invariant, or ok. Names are stable and are listed in docs/verify.md.
struct Verification {
  bool ok = true;
  std::string invariant;     ///< name of the broken invariant, e.g. "pre-order"
  std::string detail;        ///< where, and what was found instead of what
  std::uint64_t checks = 0;  ///< how many single facts were checked
};

/// Checks everything that a tree can be held to without its mesh. Works on any bytes: no link is
/// followed before it was checked. O(nodes + ids) time, O(depth) memory beside one bit a triangle.
Verification verify(const Tree& tree);

/// verify(), then that tree and mesh belong together: bounds, number of triangles, and that every
/// triangle is in every leaf it has to be in. For profile `paper` the leaves are exactly those of
/// the grid cells of its box; for the others, those its part inside the cell reaches.
Verification verify(const Tree& tree, const MeshView& mesh);

}  // namespace fasttree
