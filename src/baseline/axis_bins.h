// SPDX-License-Identifier: Apache-2.0
// Min-max binning of boxes on one axis: how many begin and how many end in each bin.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace fasttree::baseline {

inline constexpr std::size_t kBins = 32;

/// The children a box goes to. A flat box in the plane goes to the upper child, as a point does.
inline bool goes_lower(float lo, float split) {
  return lo < split;
}
inline bool goes_upper(float lo, float hi, float split) {
  return hi > split || lo >= split;
}

/// The bins of one axis. Counts are exact: a value is compared with the borders themselves, so that
/// rounding in the division cannot put a box on another side than partition() will.
class AxisBins {
 public:
  /// Spreads the bins over [lo, hi] and empties them.
  void place(float lo, float hi) {
    const double extent = double{hi} - lo;
    for (std::size_t k = 0; k <= kBins; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(kBins);
      // Adding zero turns -0 into +0.
      border_[k] = std::clamp(static_cast<float>(lo + share * extent), lo, hi) + 0.0f;
    }
    lo_ = lo;
    scale_ = extent > 0 ? static_cast<double>(kBins) / extent : 0.0;
    begins_.fill(0);
    ends_.fill(0);
  }

  /// Counts a box that lies inside the span.
  void add(float lo, float hi) {
    // begins_[i]: border i <= lo < border i + 1. ends_[i]: border i < hi <= border i + 1, but a
    // flat box ends where it begins, so that goes_upper holds for it at its own border.
    const std::size_t begin = bin_from_below(lo);
    ++begins_[begin];
    ++ends_[lo == hi ? begin : bin_from_above(hi)];
  }

  float border(std::size_t k) const { return border_[k]; }

  /// Calls visit(k, lower count, upper count) for each border in order.
  template <typename Visit>
  void sweep(std::uint64_t count, Visit&& visit) const {
    std::uint64_t lower = 0;
    std::uint64_t upper = count;
    for (std::size_t k = 0; k <= kBins; ++k) {
      if (k > 0) {
        lower += begins_[k - 1];
        upper -= ends_[k - 1];
      }
      visit(k, lower, upper);
    }
  }

 private:
  std::size_t guess(float v) const {
    return std::min(static_cast<std::size_t>((v - lo_) * scale_), kBins);
  }

  std::size_t bin_from_below(float v) const {
    std::size_t i = guess(v);
    while (i < kBins && v >= border_[i + 1]) ++i;
    while (v < border_[i]) --i;
    return i;
  }

  std::size_t bin_from_above(float v) const {
    std::size_t i = std::min(guess(v), kBins - 1);
    while (i > 0 && v <= border_[i]) --i;
    while (v > border_[i + 1]) ++i;
    return i;
  }

  std::array<float, kBins + 1> border_{};
  std::array<std::uint64_t, kBins + 1> begins_{};
  std::array<std::uint64_t, kBins + 1> ends_{};
  double lo_ = 0, scale_ = 0;
};

}  // namespace fasttree::baseline
