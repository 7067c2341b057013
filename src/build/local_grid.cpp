// SPDX-License-Identifier: Apache-2.0
#include "build/local_grid.h"

#include <algorithm>
#include <cmath>

namespace fasttree::build {

void LocalGrid::set(const Box3& bounds, int depth) {
  // The live axes and the schedule, as make_axis_levels has them; no axis gets full here.
  static_assert(kRealtimeRule.layer_most_depth <= kMaxAxisBits);
  const Vec3 extent = bounds.extent();
  const float longest = std::max({extent.x, extent.y, extent.z});
  std::array<double, 3> side;
  for (std::size_t a = 0; a < 3; ++a) {
    const float scale = finest_scale(extent[a]);
    const bool live = extent[a] > 0x1p-20f * longest && std::isfinite(scale);
    quantisers_[a] = {bounds.lo[a], live ? scale : 0.0f};
    hi_[a] = bounds.hi[a];
    side[a] = live ? static_cast<double>(extent[a]) : -1.0;
    bits_[a] = 0;
  }
  for (depth_ = 0; depth_ < depth; ++depth_) {
    std::size_t chosen = 0;
    if (side[1] > side[chosen]) chosen = 1;
    if (side[2] > side[chosen]) chosen = 2;
    if (side[chosen] < 0) break;
    side[chosen] *= 0.5;
    ++bits_[chosen];
    axis_[static_cast<std::size_t>(depth_)] = static_cast<std::uint8_t>(chosen);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    to_cells_[a] = std::ldexp(1.0f, bits_[a] - kMaxAxisBits);
  }
}

void LocalGrid::coarsen() {
  const std::size_t a = axis_[static_cast<std::size_t>(--depth_)];
  --bits_[a];
  to_cells_[a] *= 0.5f;
}

void LocalGrid::make_codes() {
  std::array<std::uint32_t, 3> size{1, 1, 1};
  code_[0][0] = code_[1][0] = code_[2][0] = 0;
  // From the last level: each doubles its axis' table.
  for (int level = depth_ - 1; level >= 0; --level) {
    const std::size_t a = axis_[static_cast<std::size_t>(level)];
    const auto bit = static_cast<std::uint16_t>(1u << (depth_ - 1 - level));
    for (std::uint32_t k = 0; k < size[a]; ++k) {
      code_[a][size[a] + k] = static_cast<std::uint16_t>(code_[a][k] | bit);
    }
    size[a] *= 2;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::uint32_t k = 0; k < size[a]; ++k) {
      const std::uint16_t here = code_[a][k];
      const std::uint16_t next = k + 1 < size[a] ? code_[a][k + 1] : here;
      for (std::size_t corner = 0; corner < 8; ++corner) {
        corners_[a][k][corner] = corner >> a & 1 ? next : here;
      }
    }
  }
}

std::uint32_t LocalGrid::coordinate_of(std::uint32_t code, std::size_t axis) const {
  std::uint32_t coordinate = 0;
  for (int level = 0; level < depth_; ++level) {
    if (axis_[static_cast<std::size_t>(level)] == axis) {
      coordinate = coordinate << 1 | (code >> (depth_ - 1 - level) & 1u);
    }
  }
  return coordinate;
}

Grid::Split LocalGrid::split_below(std::uint32_t upper_code, int m) const {
  const auto a = static_cast<std::size_t>(axis_of_level(depth_ - 1 - m));
  return {static_cast<std::uint32_t>(a), plane(a, coordinate_of(upper_code >> m << m, a))};
}

}  // namespace fasttree::build
