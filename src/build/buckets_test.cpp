// SPDX-License-Identifier: Apache-2.0
#include "build/buckets.h"

#include <gtest/gtest.h>

#include "reference/leaf_node.h"
#include "reference/radix_sort.h"
#include "tests/support/meshes.h"

namespace fasttree::build {
namespace {

// A box by its cells at the finest grid.
struct FinestBox {
  std::array<std::uint32_t, 3> lo, hi;
};

std::vector<FinestBox> random_boxes(std::uint32_t count, std::uint64_t seed, std::uint32_t size) {
  test::Random random(seed);
  std::vector<FinestBox> boxes(count);
  for (FinestBox& box : boxes) {
    for (std::size_t a = 0; a < 3; ++a) {
      box.lo[a] = random.below(kFinestCells);
      box.hi[a] = std::min(box.lo[a] + random.below(size), kFinestCells - 1);
    }
  }
  return boxes;
}

// One small box after the other in the same place, so that whole vectors share a bucket.
std::vector<FinestBox> coherent_boxes(std::uint32_t count) {
  std::vector<FinestBox> boxes(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::uint32_t at = t / 40 * 97 % (kFinestCells - 400);
    boxes[t] = {{at, at, at}, {at + t % 3 * 150, at + t % 5 * 90, at + t % 2}};
  }
  return boxes;
}

std::uint32_t code_at(const Grid& grid, const std::array<std::uint32_t, 3>& finest) {
  Cell cell;
  for (std::size_t a = 0; a < 3; ++a) cell[a] = finest[a] >> (kMaxAxisBits - grid.bits()[a]);
  return grid.morton_code(cell);
}

// Judge: every reference written out, then sorted by the reference's stable sort. The boxes are
// given at a grid `box_shift` levels deeper.
void expect_same(const std::vector<FinestBox>& boxes, const Box3& bounds, AxisSchedule schedule,
                 int depth, int box_shift, Simd simd, Buckets& buckets) {
  const AxisLevels levels = make_axis_levels(bounds, schedule);
  const Grid deep(bounds, schedule, std::min(depth + box_shift, levels.levels));
  const Grid grid(bounds, schedule, std::min(depth, deep.depth()));
  const int threads = 1 << boxes.size() % 8;  // any may be told
  const BucketGrid bucket_grid(CodeAxes(levels, grid.depth()), deep.depth() - grid.depth(),
                               threads);
  EXPECT_EQ(bucket_grid.bucket_bits() + bucket_grid.cell_bits(), grid.depth());

  reference::References refs;
  std::vector<CodeBox> code_boxes;
  for (std::uint32_t t = 0; t < boxes.size(); ++t) {
    code_boxes.push_back({code_at(deep, boxes[t].lo), code_at(deep, boxes[t].hi)});
    const Cell lo = grid.cell_of(code_at(grid, boxes[t].lo));
    const Cell hi = grid.cell_of(code_at(grid, boxes[t].hi));
    for (std::uint32_t z = lo[2]; z <= hi[2]; ++z) {
      for (std::uint32_t y = lo[1]; y <= hi[1]; ++y) {
        for (std::uint32_t x = lo[0]; x <= hi[0]; ++x) {
          refs.codes.push_back(grid.morton_code({x, y, z}));
          refs.ids.push_back(t);
        }
      }
    }
  }
  refs = reference::radix_sort(std::move(refs));
  const reference::LeafTable expected = reference::leaf_node(refs);

  count_records(code_boxes, bucket_grid, simd, buckets);
  ASSERT_EQ(buckets.reference_begin.back(), refs.size());
  place_records(code_boxes, bucket_grid, simd, buckets);
  std::vector<std::uint32_t> ids(refs.size());
  sort_buckets(bucket_grid, simd, buckets, ids);
  ASSERT_EQ(ids, refs.ids);
  std::size_t leaf = 0;
  for (std::size_t b = 0; b < bucket_grid.bucket_count(); ++b) {
    for (std::uint32_t l = 0; l < buckets.leaf_count[b]; ++l, ++leaf) {
      ASSERT_LT(leaf, expected.size());
      const LeafStart& found = buckets.leaves[buckets.leaf_begin[b] + l];
      ASSERT_EQ(found.code, expected.code[leaf]);
      ASSERT_EQ(found.first, expected.first[leaf]);
    }
  }
  EXPECT_EQ(leaf, expected.size());
}

constexpr Box3 kCube{{0, 0, 0}, {1, 1, 1}};

TEST(Buckets, EqualTheStableSortOfAllReferencesAtEveryDepth) {
  Buckets buckets;  // one for all: nothing may be left over from the build before
  for (const Box3& bounds : {kCube, Box3{{0, 0, 0}, {1, 0, 20}}, Box3{{0, 0, 0}, {0, 1, 0}}}) {
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      for (int depth = 0; depth <= 30; depth += depth < 26 ? 3 : 1) {
        for (const Simd simd : {Simd::scalar, Simd::widest}) {
          SCOPED_TRACE(std::string(to_string(axes)) + " " + std::to_string(depth));
          expect_same(random_boxes(300, 1, 3), bounds, axes, depth, 0, simd, buckets);
          expect_same(random_boxes(40, 2, depth < 20 ? 4000 : 300), bounds, axes, depth, 3, simd,
                      buckets);
          expect_same(coherent_boxes(200), bounds, axes, depth, 1, simd, buckets);
          if (HasFatalFailure()) return;
        }
      }
    }
  }
}

TEST(Buckets, KeepTheOrderAcrossChunks) {
  Buckets buckets;
  for (const Simd simd : {Simd::scalar, Simd::widest}) {
    expect_same(random_boxes(50000, 3, 100), kCube, AxisSchedule::cyclic, 17, 0, simd, buckets);
    expect_same(coherent_boxes(50000), kCube, AxisSchedule::cyclic, 17, 0, simd, buckets);
  }
}

TEST(Buckets, ExpandABucketInSeveralBlocks) {
  Buckets buckets;
  for (const Simd simd : {Simd::scalar, Simd::widest}) {
    expect_same(random_boxes(3000, 4, 12000), kCube, AxisSchedule::cyclic, 9, 0, simd, buckets);
  }
}

TEST(Buckets, SplitTheBitsSoThatRecordsFit) {
  for (int depth = 0; depth <= 30; ++depth) {
    for (const int threads : {1, 2, 3, 64, 1000}) {
      const int cells = BucketGrid::cell_bits_of(depth, threads);
      EXPECT_GE(cells, std::min(depth, 10));
      EXPECT_LE(cells, std::min(depth, BucketGrid::kMostCellBits));
      EXPECT_LE(depth - cells, 20);
    }
  }
}

}  // namespace
}  // namespace fasttree::build
