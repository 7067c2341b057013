// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/split_plane.h"

#include <algorithm>

#include "grid/float_order.h"

namespace fasttree::model::ft2 {

namespace {

// A multiply and an add for the first guess; then a quantiser answers a trial each so many cycles,
// for the next trial depends on it.
constexpr std::uint32_t kGuessCycles = 8;
constexpr std::uint32_t kTrialCycles = 5;

}  // namespace

PlaneSearch search_plane(const AxisQuantiser& quantiser, float hi, std::uint32_t finest_cell) {
  PlaneSearch search;
  // The bounds themselves are known: the lower one is in cell 0, the upper one in the last.
  const float guess = quantiser.lo + static_cast<float>(finest_cell) / quantiser.scale;
  search.plane = from_ordinal(first_reached(
      to_ordinal(quantiser.lo), to_ordinal(hi), to_ordinal(guess), [&](std::int64_t ordinal) {
        ++search.trials;
        return quantiser(from_ordinal(ordinal)) >= finest_cell;
      }));
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
