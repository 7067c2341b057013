// SPDX-License-Identifier: Apache-2.0
#include "grid/quantiser.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace fasttree {
namespace {

// Binary32 values in their order as integers; both zeros are 0.
std::int32_t to_ordinal(float v) {
  const auto i = std::bit_cast<std::int32_t>(v);
  return i >= 0 ? i : std::numeric_limits<std::int32_t>::min() - i;
}

float from_ordinal(std::int32_t i) {
  return std::bit_cast<float>(i >= 0 ? i : std::numeric_limits<std::int32_t>::min() - i);
}

}  // namespace

AxisQuantiser make_axis_quantiser(const Box3& bounds, const AxisLevels& levels, std::size_t axis) {
  if (!levels.live[axis]) return {bounds.lo[axis], 0.0f};
  return {bounds.lo[axis], finest_scale(bounds.hi[axis] - bounds.lo[axis])};
}

float find_plane(const AxisQuantiser& quantiser, float hi, std::uint32_t k) {
  const auto reaches = [&](std::int64_t ordinal) {
    return quantiser(from_ordinal(static_cast<std::int32_t>(ordinal))) >= k;
  };
  // q15(lo) = 0 < k, and q15(hi) is the last cell: extent * scale rounds to no less than 2^15 - 1.
  std::int64_t below = to_ordinal(quantiser.lo);
  std::int64_t above = to_ordinal(hi);
  // Nearly always only a few floats from where it would be without rounding: go from there in
  // doubling steps until it is passed.
  const float guess = quantiser.lo + static_cast<float>(k) / quantiser.scale;
  const std::int64_t start = to_ordinal(guess);
  if (start > below && start < above) {
    const bool down = reaches(start);
    (down ? above : below) = start;
    for (std::int64_t step = 1; above - below > step; step *= 2) {
      const std::int64_t next = down ? above - step : below + step;
      const bool reached = reaches(next);
      (reached ? above : below) = next;
      if (reached != down) break;
    }
  }
  while (above - below > 1) {
    const std::int64_t middle = below + (above - below) / 2;
    (reaches(middle) ? above : below) = middle;
  }
  return from_ordinal(static_cast<std::int32_t>(above));
}

float find_plane_near(const AxisQuantiser& quantiser, float hi, std::uint32_t k) {
  const std::int64_t least = to_ordinal(quantiser.lo);
  const std::int64_t most = to_ordinal(hi);
  const auto reached = [&](std::int64_t i) {
    return quantiser(from_ordinal(static_cast<std::int32_t>(i))) >= k;
  };
  const float guess = quantiser.lo + static_cast<float>(k) / quantiser.scale;
  std::int64_t below = std::clamp<std::int64_t>(to_ordinal(guess), least, most);
  std::int64_t above = below;
  // Steps that double: near zero, floats are much denser than the differences from `lo`.
  if (reached(below)) {
    for (std::int64_t step = 1; below > least; step *= 2) {
      below = std::max(above - step, least);
      if (!reached(below)) break;
      above = below;
    }
  } else {
    for (std::int64_t step = 1; above < most; step *= 2) {
      above = std::min(below + step, most);
      if (reached(above)) break;
      below = above;
    }
  }
  while (above - below > 1) {
    const std::int64_t middle = below + (above - below) / 2;
    (reached(middle) ? above : below) = middle;
  }
  return from_ordinal(static_cast<std::int32_t>(above));
}

std::vector<float> make_planes(const AxisQuantiser& quantiser, float hi, int bits) {
  std::vector<float> planes(std::size_t{1} << bits);
  planes[0] = quantiser.lo;
  for (std::uint32_t k = 1; k < planes.size(); ++k) {
    planes[k] = find_plane(quantiser, hi, k << (kMaxAxisBits - bits));
  }
  return planes;
}

}  // namespace fasttree
