// SPDX-License-Identifier: Apache-2.0
#include "grid/axis_schedule.h"

#include <algorithm>
#include <cmath>

namespace fasttree {

std::array<std::uint8_t, 3> AxisLevels::bits(int depth) const {
  std::array<std::uint8_t, 3> b{};
  for (int l = 0; l < depth; ++l) ++b[axis[static_cast<std::size_t>(l)]];
  return b;
}

float finest_scale(float extent) {
  return static_cast<float>(1 << kMaxAxisBits) / extent;
}

AxisLevels make_axis_levels(const Box3& bounds, AxisSchedule schedule) {
  AxisLevels result;
  const Vec3 extent = bounds.extent();
  const float longest = std::max({extent.x, extent.y, extent.z});
  for (std::size_t a = 0; a < 3; ++a) {
    result.live[a] = extent[a] > 0x1p-20f * longest && std::isfinite(finest_scale(extent[a]));
  }

  std::array<int, 3> bits{};
  const auto open = [&](std::size_t a) { return result.live[a] && bits[a] < kMaxAxisBits; };
  // The cell's side after b halvings, exact in binary64.
  const auto side = [&](std::size_t a) {
    return std::ldexp(static_cast<double>(extent[a]), -bits[a]);
  };

  std::size_t next = 0;  // cyclic: the axis to look at first
  while (result.levels < kMaxDepth && (open(0) || open(1) || open(2))) {
    std::size_t chosen = 3;
    if (schedule == AxisSchedule::cyclic) {
      while (!open(next)) next = (next + 1) % 3;
      chosen = next;
      next = (next + 1) % 3;
    } else {
      for (std::size_t a = 0; a < 3; ++a) {
        if (open(a) && (chosen == 3 || side(a) > side(chosen))) chosen = a;
      }
    }
    result.axis[static_cast<std::size_t>(result.levels++)] = static_cast<std::uint8_t>(chosen);
    ++bits[chosen];
  }
  return result;
}

}  // namespace fasttree
