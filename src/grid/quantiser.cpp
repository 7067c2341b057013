// SPDX-License-Identifier: Apache-2.0
#include "grid/quantiser.h"

#include <algorithm>

#include "grid/float_order.h"

namespace fasttree {
AxisQuantiser make_axis_quantiser(const Box3& bounds, const AxisLevels& levels, std::size_t axis) {
  if (!levels.live[axis]) return {bounds.lo[axis], 0.0f};
  return {bounds.lo[axis], finest_scale(bounds.hi[axis] - bounds.lo[axis])};
}

float find_plane(const AxisQuantiser& quantiser, float hi, std::uint32_t k) {
  // q15(lo) = 0 < k, and q15(hi) is the last cell: extent * scale rounds to no less than 2^15 - 1.
  const float guess = quantiser.lo + static_cast<float>(k) / quantiser.scale;
  return from_ordinal(
      first_reached(to_ordinal(quantiser.lo), to_ordinal(hi), to_ordinal(guess),
                    [&](std::int64_t ordinal) { return quantiser(from_ordinal(ordinal)) >= k; }));
}

float find_plane_near(const AxisQuantiser& quantiser, float hi, std::uint32_t k) {
  const std::int64_t least = to_ordinal(quantiser.lo);
  const std::int64_t most = to_ordinal(hi);
  const auto reached = [&](std::int64_t i) { return quantiser(from_ordinal(i)) >= k; };
  const float guess = quantiser.lo + static_cast<float>(k) / quantiser.scale;
  std::int64_t below = std::clamp(to_ordinal(guess), least, most);
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
  return from_ordinal(above);
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
