// SPDX-License-Identifier: Apache-2.0
// The part of a triangle inside a cell, and its bounds: what a perfect split needs.
#pragma once

#include <array>
#include <cstddef>

#include "fasttree/vec.h"

namespace fasttree::baseline {

/// A convex polygon in double: a triangle cut by a few axis-aligned planes. Each plane adds at most
/// one corner, so six faces of a cell and one split make ten. Rounding can bend a sliver so that a
/// plane cuts it more than twice; a polygon that outgrows its room is given up (size 0).
struct ClippedPolygon {
  using Point = std::array<double, 3>;
  std::array<Point, 12> points;
  std::size_t size = 0;
};

/// The triangle's part inside the closed box. Empty (size 0) where they do not meet, or given up.
ClippedPolygon clip_to_box(const std::array<Vec3, 3>& triangle, const Box3& box);

/// Cuts at a plane: the parts with p[axis] <= split and p[axis] >= split. A part that only touches
/// the plane is there, flat.
void cut(const ClippedPolygon& polygon, std::size_t axis, float split, ClippedPolygon& lower,
         ClippedPolygon& upper);

/// Bounds of a polygon that is not empty, rounded outward to binary32, then held inside `cell`.
Box3 outward_bounds(const ClippedPolygon& polygon, const Box3& cell);

/// The boxes of a triangle on both sides of a plane that halves its cell.
struct CutBounds {
  bool in_lower = false;
  bool in_upper = false;
  Box3 lower;
  Box3 upper;
};

/// Clips the triangle to both halves of `cell`. At least one side has it; a side that it only
/// touches from the other does not.
CutBounds cut_bounds(const std::array<Vec3, 3>& triangle, const Box3& cell, std::size_t axis,
                     float split);

}  // namespace fasttree::baseline
