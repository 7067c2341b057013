// SPDX-License-Identifier: Apache-2.0
// Binary32 values in their order as integers, and the search for the first of them with a property.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

namespace fasttree {

/// Both zeros are 0.
inline std::int64_t to_ordinal(float v) {
  const auto i = std::bit_cast<std::int32_t>(v);
  return i >= 0 ? i : std::numeric_limits<std::int32_t>::min() - i;
}

inline float from_ordinal(std::int64_t ordinal) {
  const auto i = static_cast<std::int32_t>(ordinal);
  return std::bit_cast<float>(i >= 0 ? i : std::numeric_limits<std::int32_t>::min() - i);
}

/// The least ordinal for which `reached` holds, which is monotone, does not hold for `below` and
/// does for `above`: neither is tried. Nearly always it is only a few floats from `start`, so the
/// search goes from there in doubling steps until it is passed, and halves what is left.
template <typename Reached>
std::int64_t first_reached(std::int64_t below, std::int64_t above, std::int64_t start,
                           const Reached& reached) {
  if (start > below && start < above) {
    const bool down = reached(start);
    (down ? above : below) = start;
    for (std::int64_t step = 1; above - below > step; step *= 2) {
      const std::int64_t next = down ? above - step : below + step;
      const bool there = reached(next);
      (there ? above : below) = next;
      if (there != down) break;
    }
  }
  while (above - below > 1) {
    const std::int64_t middle = below + (above - below) / 2;
    (reached(middle) ? above : below) = middle;
  }
  return above;
}

}  // namespace fasttree
