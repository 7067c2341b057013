// SPDX-License-Identifier: Apache-2.0
// Steps 1 and 2, fast: each vertex is looked at once for the bounds and quantised once, however
// many triangles share it. Every function has a scalar form and one for the widest instruction set;
// both give the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "grid/grid.h"

namespace fasttree::build {

/// A vertex's cell at the finest grid, and which of the bounds it touches: bit a of `touches` where
/// its coordinate is lo[a], bit 3 + a where it is hi[a].
struct VertexCell {
  std::array<std::uint16_t, 3> q{};
  std::uint16_t touches = 0;

  friend bool operator==(const VertexCell&, const VertexCell&) = default;
};
static_assert(sizeof(VertexCell) == 8);

inline constexpr std::uint16_t kTouchesAll = 0x3f;

/// Box round all vertices, used by triangles or not, plus zeros for minus zeros. False where one is
/// not finite or an extent overflows; `bounds` is void then.
bool vertex_bounds(const MeshView& mesh, Simd simd, Box3& bounds);

/// Quantises all vertices, in parallel. `cells` is resized to the number of vertices.
void quantise_vertices(const MeshView& mesh, const Box3& bounds,
                       const std::array<AxisQuantiser, 3>& quantisers, Simd simd,
                       std::vector<VertexCell>& cells);

/// The instruction set Simd::widest uses on this processor, e.g. "AVX3".
const char* widest_simd_name();

}  // namespace fasttree::build
