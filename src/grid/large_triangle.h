// SPDX-License-Identifier: Apache-2.0
// Profile `realtime`: triangles whose boxes have many cells of the top grid are put only into those
// that they overlap (docs/realtime.md). Most scenes have few or none of them.
#pragma once

#include <cstdint>

#include "grid/cell_overlap.h"
#include "grid/grid.h"
#include "grid/realtime_rule.h"

namespace fasttree {

class LargeTriangle {
 public:
  LargeTriangle(const Grid& grid, std::uint32_t id, const std::array<Vec3, 3>& triangle)
      : id_(id), origin_(grid.cells_of(triangle).lo), overlap_(in_cells(grid, triangle), origin_) {}

  static bool is_large(const Grid& grid, const std::array<Vec3, 3>& triangle) {
    return grid.cells_of(triangle).count() > kRealtimeRule.large_cells;
  }

  std::uint32_t id() const { return id_; }

  /// Whether it overlaps a cell, one of its box.
  bool overlaps(const Cell& cell) const {
    return overlap_.at(static_cast<float>(cell[0] - origin_[0]),
                       static_cast<float>(cell[1] - origin_[1]),
                       static_cast<float>(cell[2] - origin_[2]));
  }

 private:
  std::uint32_t id_;
  Cell origin_;
  CellOverlap overlap_;
};

}  // namespace fasttree
