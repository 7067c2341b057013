// SPDX-License-Identifier: Apache-2.0
// The surface-area heuristic of one cell: what a split costs, what a leaf costs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "fasttree/quality.h"
#include "fasttree/vec.h"

namespace fasttree::baseline {

/// A split that cuts off empty space counts this much of its cost (Wald and Havran 2006, the
/// "bias" lambda of their section 3).
inline constexpr double kEmptySpaceFactor = 0.8;

/// A plane, where the triangles that lie in it go, and how many references each child gets.
struct Split {
  std::uint32_t axis = 0;
  float position = 0.0f;
  bool planar_to_lower = false;
  std::uint64_t lower_count = 0;
  std::uint64_t upper_count = 0;
  double cost = 0.0;
};

/// Half the surface of a box, in double: no overflow and no underflow for any binary32 bounds.
inline double half_area(const Box3& box) {
  const double x = double{box.hi.x} - box.lo.x;
  const double y = double{box.hi.y} - box.lo.y;
  const double z = double{box.hi.z} - box.lo.z;
  return x * y + y * z + z * x;
}

/// The cost of splitting `cell` on one axis. The cell has an area.
class SplitCost {
 public:
  SplitCost(const Box3& cell, std::size_t axis, const SahCosts& costs)
      : costs_(costs), lo_(cell.lo[axis]), hi_(cell.hi[axis]) {
    const std::size_t b = (axis + 1) % 3;
    const std::size_t c = (axis + 2) % 3;
    const double eb = double{cell.hi[b]} - cell.lo[b];
    const double ec = double{cell.hi[c]} - cell.lo[c];
    // A child's half area is linear in the position of the plane.
    face_ = eb * ec;
    slope_ = eb + ec;
    inverse_area_ = 1.0 / half_area(cell);
  }

  double operator()(double split, std::uint64_t lower_count, std::uint64_t upper_count) const {
    const double lower_area = face_ + slope_ * (split - lo_);
    const double upper_area = face_ + slope_ * (hi_ - split);
    const double tests = (lower_area * static_cast<double>(lower_count) +
                          upper_area * static_cast<double>(upper_count)) *
                         inverse_area_;
    const double cost = costs_.traversal + costs_.intersection * tests;
    return lower_count == 0 || upper_count == 0 ? kEmptySpaceFactor * cost : cost;
  }

 private:
  SahCosts costs_;
  double lo_, hi_;
  double face_ = 0, slope_ = 0, inverse_area_ = 0;
};

inline double leaf_cost(std::uint64_t count, const SahCosts& costs) {
  return costs.intersection * static_cast<double>(count);
}

}  // namespace fasttree::baseline
