// SPDX-License-Identifier: Apache-2.0
#include "grid/grid.h"

#include <gtest/gtest.h>

#include "reference/scene_bound.h"
#include "tests/support/meshes.h"

namespace fasttree {
namespace {

const Box3 kUnit{{0, 0, 0}, {1, 1, 1}};

TEST(Grid, MortonCodesInterleaveTheSchedule) {
  const Grid grid(kUnit, AxisSchedule::cyclic, 6);
  EXPECT_EQ(grid.bits(), (std::array<std::uint8_t, 3>{2, 2, 2}));
  EXPECT_EQ(grid.morton_code({2, 0, 0}), 0b100000u);
  EXPECT_EQ(grid.morton_code({0, 2, 0}), 0b010000u);
  EXPECT_EQ(grid.morton_code({0, 0, 1}), 0b000001u);
  EXPECT_EQ(grid.morton_code({3, 3, 3}), 0b111111u);
}

TEST(Grid, CodesAndCellsAreEachOthersInverse) {
  test::Random random(1);
  for (const auto& bounds : {kUnit, Box3{{0, 0, 0}, {100, 3, 0.1f}}, Box3{{0, 0, 0}, {1, 0, 1}}}) {
    for (const AxisSchedule schedule : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      for (const int depth : {0, 1, 5, 17, 27, 30}) {
        const Grid grid(bounds, schedule, depth);
        for (int i = 0; i < 200; ++i) {
          const std::uint32_t code = random.below(1u << grid.depth());
          const Cell cell = grid.cell_of(code);
          ASSERT_EQ(grid.morton_code(cell), code);
          for (std::size_t a = 0; a < 3; ++a) ASSERT_LT(cell[a], 1u << grid.bits()[a]);
        }
      }
    }
  }
}

TEST(Grid, LowersADepthThatTheBoundsDoNotAllow) {
  EXPECT_EQ(Grid({{0, 0, 0}, {0, 0, 1}}, AxisSchedule::cyclic, 20).depth(), 15);
  EXPECT_EQ(Grid({{1, 1, 1}, {1, 1, 1}}, AxisSchedule::longest, 20).depth(), 0);
}

// The split between two codes separates exactly the cells below it from those above.
TEST(Grid, SplitsSeparateTheTwoLeaves) {
  test::Random random(2);
  const Grid grid({{-3, 0, 1}, {7, 1, 2}}, AxisSchedule::longest, 18);
  for (int i = 0; i < 5000; ++i) {
    std::uint32_t a = random.below(1u << 18), b = random.below(1u << 18);
    if (a == b) continue;
    if (a > b) std::swap(a, b);
    const int m = std::bit_width(a ^ b) - 1;
    const Grid::Split split = grid.split_below(b, m);
    const Cell low = grid.cell_of(a), high = grid.cell_of(b);
    const float low_plane = low[split.axis] == 0 ? -3e38f : grid.plane(split.axis, low[split.axis]);
    ASSERT_LT(low_plane, split.position);
    ASSERT_GE(grid.plane(split.axis, high[split.axis]), split.position);
    ASSERT_EQ(split.axis, static_cast<std::uint32_t>(grid.axis_of_level(18 - 1 - m)));
  }
}

TEST(Grid, CountsEqualEmissionAtEveryDepth) {
  for (const test::OwnedMesh& owned : {test::soup(50, 1, 0.2f), test::sheet(6, 0.3f),
                                       test::moved(test::soup(20, 2, 0.1f), {9, 1, 0.2f}, {})}) {
    const MeshView mesh = owned.view();
    const Box3 bounds = reference::scene_bound(mesh).value();
    for (const AxisSchedule schedule : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      const ReferenceCounts counts = count_references(mesh, bounds, schedule);
      ASSERT_EQ(counts.at[0], mesh.triangle_count);
      for (int depth = 0; depth <= 18; ++depth) {
        const Grid grid(bounds, schedule, depth);
        std::uint64_t emitted = 0;
        for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
          emitted += grid.cells_of(mesh.triangle(t)).count();
        }
        ASSERT_EQ(counts.at[static_cast<std::size_t>(depth)], emitted) << depth;
      }
    }
  }
}

ReferenceCounts doubling(std::uint64_t n, int flat_levels) {
  ReferenceCounts counts;
  counts.levels = kMaxDepth;
  for (int d = 0; d <= kMaxDepth; ++d) counts.at[d] = n << std::max(0, d - flat_levels);
  return counts;
}

TEST(DepthRule, TakesTheSmallerOfSizeAndGrowth) {
  BuildSettings settings;
  EXPECT_EQ(choose_depth(doubling(1000, 30), 1000, settings).value(), 11) << "ceil(log2) + 1";
  EXPECT_EQ(choose_depth(doubling(1024, 30), 1024, settings).value(), 11);
  EXPECT_EQ(choose_depth(doubling(1025, 30), 1025, settings).value(), 12);
  EXPECT_EQ(choose_depth(doubling(1000, 5), 1000, settings).value(), 7) << "4 N fits, 8 N does not";
  settings.max_growth = 8;
  EXPECT_EQ(choose_depth(doubling(1000, 5), 1000, settings).value(), 8);
  settings.extra_depth = -20;
  EXPECT_EQ(choose_depth(doubling(1000, 30), 1000, settings).value(), 0);
  settings.extra_depth = 25;
  settings.max_growth = 1e9;
  EXPECT_EQ(choose_depth(doubling(1000, 30), 1000, settings).value(), kMaxAutoDepth);
  EXPECT_EQ(choose_depth(doubling(0, 30), 0, {}).value(), 0) << "an empty mesh";
  EXPECT_EQ(choose_depth(doubling(1, 30), 1, {}).value(), 1);
}

TEST(DepthRule, HonoursAnExplicitDepthAndRefusesWhatCannotBeHeld) {
  BuildSettings settings;
  settings.depth = 30;
  EXPECT_EQ(choose_depth(doubling(1000, 30), 1000, settings).value(), 30);
  EXPECT_EQ(choose_depth(doubling(1000, 5), 1000, settings).status().code(),
            StatusCode::resource_limit);
  ReferenceCounts few = doubling(10, 30);
  few.levels = 15;
  EXPECT_EQ(choose_depth(few, 10, settings).value(), 15) << "all levels there are";
  for (const int depth : {31, -2}) {
    settings.depth = depth;
    EXPECT_EQ(choose_depth(few, 10, settings).status().code(), StatusCode::invalid_argument);
  }
  settings = {};
  settings.max_growth = std::nan("");
  EXPECT_EQ(choose_depth(few, 10, settings).status().code(), StatusCode::invalid_argument);
}

}  // namespace
}  // namespace fasttree
