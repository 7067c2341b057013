// SPDX-License-Identifier: Apache-2.0
// Steps 1 and 2, fast: each vertex is looked at once for the bounds and becomes a Morton code once,
// however many triangles share it. Every function has a scalar form and one for the widest
// instruction set; both give the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "build/bit_spread.h"
#include "build/buffer.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "grid/grid.h"

namespace fasttree::build {

/// What turns a position into the code of its cell at one depth.
struct VertexEncoder {
  VertexEncoder(const Box3& bounds, const AxisLevels& schedule, int depth);

  std::array<AxisQuantiser, 3> quantisers;
  CodeAxes axes;
  Box3 bounds;
  /// The bounds, with NaN, which nothing equals, on axes without extent: there every vertex
  /// touches both sides, and no triangle has to be asked.
  Box3 sides;
};

/// Set in the code of a vertex that touches a side of the bounds, and of one that lies outside or
/// is not finite; no code has more than 30 bits.
inline constexpr std::uint32_t kTouchesBounds = 1u << 31;
inline constexpr std::uint32_t kOutside = 1u << 30;
static_assert(kMaxDepth <= 30);

/// Box round all vertices, used by triangles or not, but the `skipped` ones, which are given in
/// ascending order; plus zeros for minus zeros. False where one is not finite, there is none, or an
/// extent overflows; `bounds` is void then.
bool vertex_bounds(const MeshView& mesh, std::span<const std::uint32_t> skipped, Simd simd,
                   Box3& bounds);

/// The codes of all vertices, in parallel. `codes` is resized to the number of vertices.
void encode_vertices(const MeshView& mesh, const VertexEncoder& encoder, Simd simd,
                     Buffer<std::uint32_t>& codes);

/// The instruction set Simd::widest uses on this processor, e.g. "AVX3".
const char* widest_simd_name();

}  // namespace fasttree::build
