// SPDX-License-Identifier: Apache-2.0
// One layer of profile `realtime`: the grid over a list of triangles, and which of them its cells
// get. Docs: docs/realtime.md.
#pragma once

#include <cstdint>
#include <vector>

#include "fasttree/mesh.h"
#include "fasttree/vec.h"
#include "grid/grid.h"

namespace fasttree::reference {

/// Triangles that share a cell, and what may be made of them.
struct LayerList {
  std::vector<std::uint32_t> ids;  ///< ascending
  Box3 cell;
  std::uint64_t budget = 0;  ///< references that the leaves below may have in all
  int layer = 0;             ///< layers above, the top grid not counted
  int levels_left = 0;       ///< inner nodes that a leaf may still have above it
};

/// The cells of the list's grid that hold something, in Morton order; none where the list is a
/// leaf.
struct Layer {
  Grid grid;
  std::vector<std::uint32_t> code;
  std::vector<LayerList> children;
};

Layer make_layer(const MeshView& mesh, const LayerList& list);

}  // namespace fasttree::reference
