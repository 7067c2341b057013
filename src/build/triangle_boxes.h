// SPDX-License-Identifier: Apache-2.0
// Step 2, fast, first half: the cells of each triangle's box, and M(D).
#pragma once

#include <cstdint>
#include <span>

#include "build/bit_spread.h"
#include "build/buffer.h"
#include "build/vertex_codes.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "grid/grid.h"

namespace fasttree::build {

/// A triangle's box by the Morton codes of its corners, both included. Shifted right by k bits they
/// are those at k levels less.
struct CodeBox {
  std::uint32_t lo;
  std::uint32_t hi;

  friend bool operator==(const CodeBox&, const CodeBox&) = default;
};

/// Bit a: a vertex's coordinate is lo[a] of the bounds; bit 3 + a: it is hi[a].
using Touches = unsigned;
inline constexpr Touches kTouchesAll = 0x3f;

/// What the pass over the triangles finds out.
struct BoxPass {
  std::uint64_t references = 0;  ///< M at the depth of the codes
  bool indices_ok = true;        ///< false: some index names no vertex; the rest is void
  bool inside = true;            ///< no triangle has a vertex outside the bounds
  Touches touches = 0;           ///< over all vertices that triangles use
};

/// Boxes of all triangles from their vertices' codes, in parallel. `boxes` is resized.
BoxPass box_triangles(const MeshView& mesh, const Box3& bounds,
                      std::span<const std::uint32_t> codes, const CodeAxes& axes, Simd simd,
                      Buffer<CodeBox>& boxes);

/// M(D) for D = 0..depth of the boxes, in parallel.
ReferenceCounts count_references(std::span<const CodeBox> boxes, const AxisLevels& schedule,
                                 int depth);

}  // namespace fasttree::build
