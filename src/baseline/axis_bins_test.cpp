// SPDX-License-Identifier: Apache-2.0
#include "baseline/axis_bins.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace fasttree::baseline {
namespace {

/// Boxes with ends on borders, next to borders, and anywhere; a third of them flat.
std::vector<std::pair<float, float>> random_spans(std::mt19937& rng, float lo, float hi) {
  AxisBins bins;
  bins.place(lo, hi);
  std::uniform_real_distribution<double> unit(0, 1);
  const float inf = std::numeric_limits<float>::infinity();
  const auto value = [&] {
    float v = static_cast<float>(lo + unit(rng) * (double{hi} - lo));
    const std::uint32_t kind = rng() % 4;
    if (kind > 0) v = bins.border(rng() % (kBins + 1));
    if (kind == 2) v = std::nextafterf(v, inf);
    if (kind == 3) v = std::nextafterf(v, -inf);
    return std::clamp(v, lo, hi);
  };
  std::vector<std::pair<float, float>> spans{{lo, lo}, {hi, hi}, {lo, hi}};
  for (int i = 0; i < 200; ++i) {
    float a = value();
    float b = rng() % 3 == 0 ? a : value();
    if (a > b) std::swap(a, b);
    spans.push_back({a, b});
  }
  return spans;
}

void check_counts(std::mt19937& rng, float lo, float hi) {
  const auto spans = random_spans(rng, lo, hi);
  AxisBins bins;
  bins.place(lo, hi);
  for (const auto& [a, b] : spans) bins.add(a, b);
  RC_ASSERT(bins.border(0) == lo);
  RC_ASSERT(bins.border(kBins) == hi);
  std::size_t visited = 0;
  bins.sweep(spans.size(), [&](std::size_t k, std::uint64_t lower, std::uint64_t upper) {
    RC_ASSERT(k == visited++);
    std::uint64_t expected_lower = 0, expected_upper = 0;
    for (const auto& [a, b] : spans) {
      expected_lower += goes_lower(a, bins.border(k));
      expected_upper += goes_upper(a, b, bins.border(k));
    }
    RC_ASSERT(lower == expected_lower);
    RC_ASSERT(upper == expected_upper);
  });
  RC_ASSERT(visited == kBins + 1);
}

TEST(AxisBins, CountsWhatPartitionWillFind) {
  const bool ok = rc::check("counts at borders are exact", [](std::uint32_t seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<float> d(-10, 10);
    float lo = d(rng), hi = d(rng);
    if (lo > hi) std::swap(lo, hi);
    check_counts(rng, lo, hi);
    check_counts(rng, 0.0f, 1.0f);
    check_counts(rng, 1e6f, 1e6f + 1.0f);
    check_counts(rng, 1.0f, std::nextafterf(1.0f, 2.0f));
    check_counts(rng, 0.0f, 1e-44f);
    check_counts(rng, -3e38f, 3e38f);
    check_counts(rng, 7.0f, 7.0f);
  });
  ASSERT_TRUE(ok);
}

}  // namespace
}  // namespace fasttree::baseline
