// SPDX-License-Identifier: Apache-2.0
// Step 2, fast, first half: the cells of each triangle's box, and M(D) for every depth.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "build/vertex_cells.h"
#include "fasttree/mesh.h"
#include "grid/grid.h"

namespace fasttree::build {

/// A triangle's cells at the finest grid, both corners included; the fourth lane is unused.
struct TriangleBox {
  std::array<std::uint16_t, 4> lo{};
  std::array<std::uint16_t, 4> hi{};
};

/// What one pass over the triangles finds out.
struct BoxPass {
  ReferenceCounts counts;     ///< M(D) for D up to the asked number of levels
  bool indices_ok = true;     ///< false: some index names no vertex; the rest is void
  std::uint16_t touches = 0;  ///< VertexCell::touches over all vertices that triangles use
};

/// Boxes of all triangles from their vertices' cells, in parallel. `boxes` is resized.
BoxPass box_triangles(const MeshView& mesh, std::span<const VertexCell> cells,
                      const AxisLevels& schedule, int levels, Simd simd,
                      std::vector<TriangleBox>& boxes);

}  // namespace fasttree::build
