// SPDX-License-Identifier: Apache-2.0
// Step 2, fast, first half: the cells of each triangle's box, and M(D).
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

/// What the pass over the triangles finds out.
struct BoxPass {
  std::array<std::uint64_t, 2> references{};  ///< M of the two depths that were asked for
  bool indices_ok = true;     ///< false: some index names no vertex; the rest is void
  std::uint16_t touches = 0;  ///< VertexCell::touches over all vertices that triangles use
};

/// Boxes of all triangles from their vertices' cells, in parallel, and M at two depths of the
/// schedule. `boxes` is resized.
BoxPass box_triangles(const MeshView& mesh, std::span<const VertexCell> cells,
                      const AxisLevels& schedule, std::array<int, 2> depths,
                      std::vector<TriangleBox>& boxes);

/// M(D) for D = 0..levels of the schedule, in parallel.
ReferenceCounts count_references(std::span<const TriangleBox> boxes, const AxisLevels& schedule);

}  // namespace fasttree::build
