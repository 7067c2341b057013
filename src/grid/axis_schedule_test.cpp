// SPDX-License-Identifier: Apache-2.0
#include "grid/axis_schedule.h"

#include <gtest/gtest.h>

#include <numeric>

namespace fasttree {
namespace {

Box3 box(float x, float y, float z) {
  return {{0, 0, 0}, {x, y, z}};
}

std::vector<int> first(const AxisLevels& levels, int n) {
  return {levels.axis.begin(), levels.axis.begin() + n};
}

TEST(AxisSchedule, CyclicGoesRoundTheLiveAxes) {
  EXPECT_EQ(first(make_axis_levels(box(1, 2, 3), AxisSchedule::cyclic), 7),
            (std::vector<int>{0, 1, 2, 0, 1, 2, 0}));
  EXPECT_EQ(first(make_axis_levels(box(1, 0, 3), AxisSchedule::cyclic), 5),
            (std::vector<int>{0, 2, 0, 2, 0}));
}

TEST(AxisSchedule, LongestHalvesTheLongestSideTiesToTheLowestAxis) {
  EXPECT_EQ(first(make_axis_levels(box(1, 1, 1), AxisSchedule::longest), 6),
            (std::vector<int>{0, 1, 2, 0, 1, 2}));
  // Sides 8, 2, 1: x twice to 2, then x before y, and so on.
  EXPECT_EQ(first(make_axis_levels(box(8, 2, 1), AxisSchedule::longest), 7),
            (std::vector<int>{0, 0, 0, 1, 0, 1, 2}));
}

TEST(AxisSchedule, HasAtMostFifteenBitsAnAxis) {
  for (const AxisSchedule schedule : {AxisSchedule::cyclic, AxisSchedule::longest}) {
    const AxisLevels one = make_axis_levels(box(0, 5, 0), schedule);
    EXPECT_EQ(one.levels, 15);
    EXPECT_EQ(one.bits(15), (std::array<std::uint8_t, 3>{0, 15, 0}));
    const AxisLevels two = make_axis_levels(box(1, 0, 1000), schedule);
    EXPECT_EQ(two.levels, 30);
    EXPECT_EQ(two.bits(30), (std::array<std::uint8_t, 3>{15, 0, 15}));
    const AxisLevels long_one = make_axis_levels(box(1, 1, 1e5f), schedule);
    EXPECT_EQ(long_one.levels, 30);
    EXPECT_LE(long_one.bits(30)[2], 15);
  }
}

TEST(AxisSchedule, AxesDieAtTwoToTheMinusTwenty) {
  EXPECT_FALSE(make_axis_levels(box(1, 0x1p-20f, 1), AxisSchedule::cyclic).live[1]);
  EXPECT_TRUE(make_axis_levels(box(1, 0x1.000002p-20f, 1), AxisSchedule::cyclic).live[1]);
}

TEST(AxisSchedule, AxesDieWhereTheScaleOverflows) {
  // 2^15 / e is finite exactly while e > 2^15 / largest.
  const AxisLevels subnormal = make_axis_levels(box(1e-40f, 1e-40f, 1e-40f), AxisSchedule::cyclic);
  EXPECT_EQ(subnormal.levels, 0);
  const AxisLevels tiny = make_axis_levels(box(1e-33f, 1e-33f, 1e-33f), AxisSchedule::longest);
  EXPECT_EQ(tiny.levels, 30);
  EXPECT_EQ(make_axis_levels(box(0, 0, 0), AxisSchedule::longest).levels, 0);
}

}  // namespace
}  // namespace fasttree
