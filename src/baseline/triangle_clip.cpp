// SPDX-License-Identifier: Apache-2.0
// Clipping by one plane after another (Sutherland and Hodgman 1974). Double carries 29 bits more
// than the coordinates, so a corner is wrong by far less than the binary32 step its bound is
// rounded to; a corner made by a plane lies in that plane exactly.
#include "baseline/triangle_clip.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fasttree::baseline {
namespace {

enum class Keep { below, above };

void clip(const ClippedPolygon& in, std::size_t axis, double plane, Keep keep,
          ClippedPolygon& out) {
  const double sign = keep == Keep::above ? 1.0 : -1.0;
  out.size = 0;
  for (std::size_t i = 0; i < in.size; ++i) {
    if (out.size + 2 > out.points.size()) {
      out.size = 0;
      return;
    }
    const auto& a = in.points[i];
    const auto& b = in.points[i + 1 == in.size ? 0 : i + 1];
    const double da = sign * (a[axis] - plane);
    const double db = sign * (b[axis] - plane);
    if (da >= 0) out.points[out.size++] = a;
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      const double t = da / (da - db);
      auto& p = out.points[out.size++];
      for (std::size_t k = 0; k < 3; ++k) p[k] = a[k] + t * (b[k] - a[k]);
      p[axis] = plane;
    }
  }
}

bool any_beyond(const ClippedPolygon& polygon, std::size_t axis, double plane, Keep keep) {
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const double v = polygon.points[i][axis];
    if (keep == Keep::above ? v < plane : v > plane) return true;
  }
  return false;
}

float round_down(double v) {
  const float f = static_cast<float>(v);
  return double{f} > v ? std::nextafterf(f, -std::numeric_limits<float>::infinity()) : f;
}

float round_up(double v) {
  const float f = static_cast<float>(v);
  return double{f} < v ? std::nextafterf(f, std::numeric_limits<float>::infinity()) : f;
}

/// The triangle's own box inside the cell: a safe stand-in for the bounds of its part.
Box3 bounds_in_cell(const std::array<Vec3, 3>& triangle, const Box3& cell) {
  Box3 box;
  for (const Vec3& p : triangle) box.include(p);
  for (std::size_t a = 0; a < 3; ++a) {
    box.lo[a] = std::clamp(box.lo[a], cell.lo[a], cell.hi[a]);
    box.hi[a] = std::clamp(box.hi[a], cell.lo[a], cell.hi[a]);
  }
  return box;
}

}  // namespace

ClippedPolygon clip_to_box(const std::array<Vec3, 3>& triangle, const Box3& box) {
  ClippedPolygon polygon;
  polygon.size = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    polygon.points[i] = {triangle[i].x, triangle[i].y, triangle[i].z};
  }
  ClippedPolygon next;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const Keep keep : {Keep::above, Keep::below}) {
      const double plane = keep == Keep::above ? box.lo[axis] : box.hi[axis];
      if (!any_beyond(polygon, axis, plane, keep)) continue;
      clip(polygon, axis, plane, keep, next);
      std::swap(polygon, next);
    }
  }
  return polygon;
}

void cut(const ClippedPolygon& polygon, std::size_t axis, float split, ClippedPolygon& lower,
         ClippedPolygon& upper) {
  clip(polygon, axis, split, Keep::below, lower);
  clip(polygon, axis, split, Keep::above, upper);
}

Box3 outward_bounds(const ClippedPolygon& polygon, const Box3& cell) {
  Box3 box;
  for (std::size_t a = 0; a < 3; ++a) {
    double lo = polygon.points[0][a];
    double hi = lo;
    for (std::size_t i = 1; i < polygon.size; ++i) {
      lo = std::min(lo, polygon.points[i][a]);
      hi = std::max(hi, polygon.points[i][a]);
    }
    // The cell's faces are binary32: clamping first keeps the rounding inside and finite.
    box.lo[a] = round_down(std::clamp(lo, double{cell.lo[a]}, double{cell.hi[a]}));
    box.hi[a] = round_up(std::clamp(hi, double{cell.lo[a]}, double{cell.hi[a]}));
  }
  return box;
}

CutBounds cut_bounds(const std::array<Vec3, 3>& triangle, const Box3& cell, std::size_t axis,
                     float split) {
  Box3 lower_cell = cell;
  Box3 upper_cell = cell;
  lower_cell.hi[axis] = split;
  upper_cell.lo[axis] = split;

  const auto part_bounds = [&](const ClippedPolygon& part, const Box3& half) {
    return part.size != 0 ? outward_bounds(part, half) : bounds_in_cell(triangle, half);
  };

  CutBounds result;
  ClippedPolygon lower;
  ClippedPolygon upper;
  const ClippedPolygon polygon = clip_to_box(triangle, cell);
  if (polygon.size != 0) {
    result.in_lower = any_beyond(polygon, axis, split, Keep::above);
    result.in_upper = any_beyond(polygon, axis, split, Keep::below) || !result.in_lower;
    cut(polygon, axis, split, lower, upper);
  } else {
    // Only rounding can lose a triangle that its parent's cell had.
    result.in_lower = result.in_upper = true;
  }
  if (result.in_lower) result.lower = part_bounds(lower, lower_cell);
  if (result.in_upper) result.upper = part_bounds(upper, upper_cell);
  return result;
}

}  // namespace fasttree::baseline
