// SPDX-License-Identifier: Apache-2.0
// The grid of one layer of profile `realtime`: the same as Grid with schedule `longest`, to the
// bit, without its tables and planes, as there are thousands of them in a build.
#pragma once

#include <array>
#include <cstdint>

#include "fasttree/vec.h"
#include "grid/grid.h"
#include "grid/realtime_rule.h"

namespace fasttree::build {

class LocalGrid {
 public:
  /// `depth` is at most kRealtimeRule.layer_most_depth, and lowered to the levels there are.
  void set(const Box3& bounds, int depth);

  /// Takes the last level away. Only the codes are to be made again.
  void coarsen();

  /// Makes the tables for morton code bits; call when the depth is settled.
  void make_codes();

  int depth() const { return depth_; }
  int bits(std::size_t axis) const { return bits_[axis]; }
  int axis_of_level(int level) const { return axis_[static_cast<std::size_t>(level)]; }
  const AxisQuantiser& quantiser(std::size_t axis) const { return quantisers_[axis]; }

  /// From a coordinate times the quantiser's scale to units of cells.
  float to_cells(std::size_t axis) const { return to_cells_[axis]; }

  std::uint32_t code_bits(std::size_t axis, std::uint32_t cell) const { return code_[axis][cell]; }
  /// For each of the two by two by two cells from `cell` on this axis, bit x + 2 y + 4 z, its bits
  /// of the code: those of the three axes together are the cells' codes.
  using Corners = std::array<std::uint16_t, 8>;
  const Corners& corners(std::size_t axis, std::uint32_t cell) const {
    return corners_[axis][cell];
  }

  std::uint32_t coordinate_of(std::uint32_t code, std::size_t axis) const;

  float plane(std::size_t axis, std::uint32_t k) const {
    return find_plane_near(quantisers_[axis], hi_[axis], k << (kMaxAxisBits - bits_[axis]));
  }

  /// As Grid::split_below.
  Grid::Split split_below(std::uint32_t upper_code, int m) const;

 private:
  static constexpr std::size_t kMostLevels = kRealtimeRule.layer_most_depth;

  int depth_ = 0;
  std::array<std::uint8_t, kMostLevels> axis_{};
  std::array<int, 3> bits_{};
  std::array<AxisQuantiser, 3> quantisers_;
  std::array<float, 3> hi_{};
  std::array<float, 3> to_cells_{};
  std::array<std::array<std::uint16_t, std::size_t{1} << kMostLevels>, 3> code_;
  std::array<std::array<Corners, std::size_t{1} << kMostLevels>, 3> corners_;
};

}  // namespace fasttree::build
