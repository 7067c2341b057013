// SPDX-License-Identifier: Apache-2.0
// The grid as the accelerator wires it: a bucket is a prefix of the Morton code, the rest of the
// code numbers the cells inside it, and the lowest three levels number the cells of a block whose
// counters lie in one word.
#pragma once

#include <array>
#include <cstdint>

#include "grid/grid.h"

namespace fasttree::model::ft2 {

inline constexpr std::uint32_t kBlockCells = 8;

/// Bits of the coordinates below every prefix, and what a box covers inside a block.
class CellLevels {
 public:
  CellLevels() : CellLevels(Grid()) {}
  explicit CellLevels(Grid grid);

  const Grid& grid() const { return grid_; }
  int depth() const { return grid_.depth(); }

  /// Bits of each axis' coordinate inside a bucket whose prefix has `prefix_bits` bits.
  const std::array<std::uint8_t, 3>& bits_below(int prefix_bits) const {
    return below_[static_cast<std::size_t>(prefix_bits)];
  }
  /// Bits of each axis inside a block: the lowest three levels, or all of fewer.
  const std::array<std::uint8_t, 3>& block_bits() const { return block_bits_; }

  /// The cells of a block between two coordinates inside it, on one axis: bit c is cell c.
  std::uint8_t covered(std::size_t axis, std::uint32_t lo, std::uint32_t hi) const {
    return covered_[axis][lo][hi];
  }

 private:
  Grid grid_;
  std::array<std::array<std::uint8_t, 3>, kMaxDepth + 1> below_{};
  std::array<std::uint8_t, 3> block_bits_{};
  std::uint8_t covered_[3][kBlockCells][kBlockCells] = {};
};

/// Goes over a box in steps of a coarser cell of `shift` bits an axis, x fastest.
class BoxWalk {
 public:
  BoxWalk() = default;
  BoxWalk(const CellBox& box, const std::array<std::uint8_t, 3>& shift);

  bool active() const { return active_; }
  /// The coarser cell, in units of its size.
  const Cell& at() const { return at_; }
  /// The part of the box inside it, relative to its corner.
  CellBox inside() const;
  void advance();

 private:
  CellBox box_;
  std::array<std::uint8_t, 3> shift_{};
  Cell first_{}, last_{}, at_{};
  bool active_ = false;
};

}  // namespace fasttree::model::ft2
