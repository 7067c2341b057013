// SPDX-License-Identifier: Apache-2.0
#include "grid/quantiser.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>

#include "tests/support/meshes.h"

namespace fasttree {
namespace {

struct Axis {
  AxisQuantiser quantiser;
  float hi;
};

Axis make_axis(float lo, float hi) {
  const Box3 bounds{{lo, lo, lo}, {hi, hi, hi}};
  const AxisLevels levels = make_axis_levels(bounds, AxisSchedule::cyclic);
  return {make_axis_quantiser(bounds, levels, 0), hi};
}

const std::vector<std::pair<float, float>> kRanges{
    {0, 1},           {-1, 1},          {-0.1083f, 0.0966f}, {1e6f, 1e6f + 1}, {-17.4f, 17.417f},
    {1e4f, 1e4f + 1}, {1e-33f, 3e-33f}, {-1e38f, 1e38f},     {0, 3.4e38f},     {-1, 1e-3f},
    {-3e-20f, 1},     {0.1f, 0.3f}};

TEST(Quantiser, ClampsToTheCells) {
  const Axis axis = make_axis(-1, 1);
  EXPECT_EQ(axis.quantiser(-1), 0u);
  EXPECT_EQ(axis.quantiser(-5), 0u);
  EXPECT_EQ(axis.quantiser(1), kFinestCells - 1);
  EXPECT_EQ(axis.quantiser(1e30f), kFinestCells - 1);
  EXPECT_EQ(axis.quantiser(0), kFinestCells / 2);
  EXPECT_EQ(AxisQuantiser{}(123.0f), 0u) << "a dead axis has one cell";
}

TEST(Quantiser, LastCellHoldsTheUpperBound) {
  for (const auto& [lo, hi] : kRanges) {
    const Axis axis = make_axis(lo, hi);
    EXPECT_EQ(axis.quantiser(lo), 0u);
    EXPECT_EQ(axis.quantiser(hi), kFinestCells - 1) << lo << ' ' << hi;
  }
}

// v >= plane(k) exactly when q(v) >= k, at the plane, one float below it and anywhere else.
TEST(Quantiser, PlanesSeparateTheCellsExactly) {
  test::Random random(3);
  for (const auto& [lo, hi] : kRanges) {
    const Axis axis = make_axis(lo, hi);
    for (const int bits : {1, 4, 7, 15}) {
      const std::vector<float> planes = make_planes(axis.quantiser, hi, bits);
      const int shift = kMaxAxisBits - bits;
      for (std::uint32_t k = 1; k < planes.size(); ++k) {
        const float plane = planes[k];
        ASSERT_GE(axis.quantiser(plane) >> shift, k) << lo << ' ' << hi << ' ' << bits;
        ASSERT_LT(axis.quantiser(std::nextafter(plane, -INFINITY)) >> shift, k);
        ASSERT_FALSE(std::signbit(plane) && plane == 0.0f);
        ASSERT_LE(planes[k - 1], plane);
      }
      for (int i = 0; i < 2000; ++i) {
        const float v = lo + (hi * random.in(0, 1) - lo * random.in(0, 1));
        const std::uint32_t q = axis.quantiser(v) >> shift;
        ASSERT_TRUE(q == 0 || v >= planes[q]);
        ASSERT_TRUE(q + 1 == planes.size() || v < planes[q + 1]);
      }
    }
  }
}

TEST(Quantiser, IsMonotone) {
  EXPECT_TRUE(rc::check("q(a) <= q(b) where a <= b", [] {
    const auto& [lo, hi] = kRanges[*rc::gen::inRange<std::size_t>(0, kRanges.size())];
    const Axis axis = make_axis(lo, hi);
    float a = std::bit_cast<float>(*rc::gen::arbitrary<std::uint32_t>());
    float b = std::bit_cast<float>(*rc::gen::arbitrary<std::uint32_t>());
    RC_PRE(std::isfinite(a) && std::isfinite(b));
    if (a > b) std::swap(a, b);
    RC_ASSERT(axis.quantiser(a) <= axis.quantiser(b));
  }));
}

// The definition says q_b = q_15 >> (15 - b); that this equals quantising with 2^b / e is why.
TEST(Quantiser, IsNested) {
  test::Random random(5);
  for (const auto& [lo, hi] : kRanges) {
    const float extent = hi - lo;
    const Axis axis = make_axis(lo, hi);
    for (int b = 1; b <= 15; ++b) {
      const float scale = static_cast<float>(1 << b) / extent;
      if (!std::isnormal(scale)) continue;
      for (int i = 0; i < 500; ++i) {
        const float v = std::min(hi, std::max(lo, lo + extent * random.in(0, 1)));
        const float x = (v - lo) * scale;
        const auto direct = std::min(static_cast<std::uint32_t>(x), (1u << b) - 1);
        ASSERT_EQ(direct, axis.quantiser(v) >> (15 - b)) << lo << ' ' << hi << ' ' << b << ' ' << v;
      }
    }
  }
}

}  // namespace
}  // namespace fasttree
