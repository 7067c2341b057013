// SPDX-License-Identifier: Apache-2.0
// From a coordinate to a cell, and the planes that follow from it.
//
// The quantiser is the definition:  q15(v) = clamp(truncate((v - lo) * (2^15 / extent)), 0,
// 2^15-1), each operation rounded to binary32 and never fused. With b bits on the axis q is q15 >>
// (15 - b). It is monotone, so the range of a triangle's cells is the range of its vertices' cells.
#pragma once

#include <cstdint>
#include <vector>

#include "fasttree/vec.h"
#include "grid/axis_schedule.h"

namespace fasttree {

inline constexpr std::uint32_t kFinestCells = 1u << kMaxAxisBits;

/// The quantiser of one axis at the finest grid. A dead axis has scale 0: everything is in cell 0.
struct AxisQuantiser {
  float lo = 0.0f;
  float scale = 0.0f;

  std::uint32_t operator()(float v) const {
    const float x = (v - lo) * scale;
    if (!(x > 0.0f)) return 0;  // also what lies below the bounds
    if (x >= static_cast<float>(kFinestCells - 1)) return kFinestCells - 1;
    return static_cast<std::uint32_t>(x);
  }
};

AxisQuantiser make_axis_quantiser(const Box3& bounds, const AxisLevels& levels, std::size_t axis);

/// The smallest binary32 v with q15(v) >= k, 1 <= k < 2^15, so that v >= plane exactly when
/// q15(v) >= k. Plus zero rather than minus zero. `hi` is the upper bound of the axis.
float find_plane(const AxisQuantiser& quantiser, float hi, std::uint32_t k);

/// The same, faster: from lo + k / scale, which is a few units in the last place away mostly.
float find_plane_near(const AxisQuantiser& quantiser, float hi, std::uint32_t k);

/// Planes of an axis with `bits` bits: element k (1 <= k < 2^bits) is the plane below cell k.
/// Element 0 is the lower bound.
std::vector<float> make_planes(const AxisQuantiser& quantiser, float hi, int bits);

}  // namespace fasttree
