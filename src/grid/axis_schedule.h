// SPDX-License-Identifier: Apache-2.0
// Which axis each level of the complete tree halves.
#pragma once

#include <array>
#include <cstdint>

#include "fasttree/tree.h"
#include "fasttree/vec.h"

namespace fasttree {

inline constexpr int kMaxDepth = 30;      ///< levels of the grid, bits of a Morton code
inline constexpr int kMaxAutoDepth = 27;  ///< the most the depth rule chooses by itself
inline constexpr int kMaxAxisBits = 15;   ///< bits of a cell coordinate on one axis

/// The schedule for depth kMaxDepth; that for a smaller depth is its beginning.
struct AxisLevels {
  std::array<std::uint8_t, kMaxDepth> axis{};  ///< axis[l], l < levels: level 0 is the root
  int levels = 0;                              ///< fewer than kMaxDepth where axes are dead
  std::array<bool, 3> live{};                  ///< axes that are halved at all

  /// Bits each axis has at a depth.
  std::array<std::uint8_t, 3> bits(int depth) const;
};

/// The quantiser's scale at the finest grid: 2^15 / extent, binary32.
float finest_scale(float extent);

/// An axis is dead where its extent is at most 2^-20 of the longest one, or where its scale is not
/// finite. All axes dead: no levels.
AxisLevels make_axis_levels(const Box3& bounds, AxisSchedule schedule);

}  // namespace fasttree
