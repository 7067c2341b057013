// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/split_plane.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace fasttree::model::ft2 {

namespace {

// A multiply and an add for the first guess; then a quantiser answers a trial each so many cycles,
// for the next trial depends on it.
constexpr std::uint32_t kGuessCycles = 8;
constexpr std::uint32_t kTrialCycles = 5;

// Floats in their order as integers.
std::int64_t to_ordinal(float v) {
  const auto i = std::bit_cast<std::int32_t>(v);
  return i >= 0 ? i : std::int64_t{std::numeric_limits<std::int32_t>::min()} - i;
}
float from_ordinal(std::int64_t ordinal) {
  const auto i = static_cast<std::int32_t>(ordinal);
  return std::bit_cast<float>(i >= 0 ? i : std::numeric_limits<std::int32_t>::min() - i);
}

}  // namespace

PlaneSearch search_plane(const AxisQuantiser& quantiser, float hi, std::uint32_t finest_cell) {
  PlaneSearch search;
  const auto reached = [&](std::int64_t ordinal) {
    ++search.trials;
    return quantiser(from_ordinal(ordinal)) >= finest_cell;
  };
  // The bounds themselves are known: the lower one is in cell 0, the upper one in the last.
  std::int64_t below = to_ordinal(quantiser.lo);
  std::int64_t above = to_ordinal(hi);
  const float guess = quantiser.lo + static_cast<float>(finest_cell) / quantiser.scale;
  const std::int64_t start = to_ordinal(guess);
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
  search.plane = from_ordinal(above);
  return search;
}

SplitPlanes::SplitPlanes(const Registers& registers) : r_(registers) {
  for (auto& axis : cache_) axis.resize(registers.config.plane_cache);
}

void SplitPlanes::begin() {
  for (auto& axis : cache_) std::fill(axis.begin(), axis.end(), Entry());
}

SplitPlanes::Answer SplitPlanes::find(std::size_t axis, std::uint32_t k) {
  Entry& entry = cache_[axis][k & (cache_[axis].size() - 1)];
  if (k != 0 && entry.k == k) {
    ++hits_;
    return {entry.plane, 1};
  }
  ++misses_;
  const Grid& grid = r_.levels.grid();
  const PlaneSearch search = search_plane(grid.quantiser(axis), grid.bounds().hi[axis],
                                          k << (kMaxAxisBits - grid.bits()[axis]));
  entry = {k, search.plane};
  return {search.plane, kGuessCycles + kTrialCycles * search.trials};
}

}  // namespace fasttree::model::ft2
