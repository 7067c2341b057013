// SPDX-License-Identifier: Apache-2.0
#include "build/buckets.h"

#include <gtest/gtest.h>

#include "reference/leaf_node.h"
#include "reference/radix_sort.h"
#include "tests/support/meshes.h"

namespace fasttree::build {
namespace {

std::vector<TriangleBox> random_boxes(std::uint32_t count, std::uint64_t seed, std::uint32_t size) {
  test::Random random(seed);
  std::vector<TriangleBox> boxes(count);
  for (TriangleBox& box : boxes) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::uint32_t lo = random.below(kFinestCells);
      box.lo[a] = static_cast<std::uint16_t>(lo);
      box.hi[a] = static_cast<std::uint16_t>(std::min(lo + random.below(size), kFinestCells - 1));
    }
  }
  return boxes;
}

// Judge: every reference written out, then sorted by the reference's stable sort.
void expect_same(const std::vector<TriangleBox>& boxes, const Grid& grid, Buckets& buckets) {
  reference::References refs;
  std::uint64_t records = 0;
  const int bucket_bits = BucketGrid::bucket_bits_of(grid.depth());
  const Grid coarse(grid.bounds(), grid.schedule(), bucket_bits);
  for (std::uint32_t t = 0; t < boxes.size(); ++t) {
    const auto at = [&](const Grid& g, const std::array<std::uint16_t, 4>& corner) {
      Cell cell;
      for (std::size_t a = 0; a < 3; ++a) cell[a] = corner[a] >> (kMaxAxisBits - g.bits()[a]);
      return cell;
    };
    records += CellBox{at(coarse, boxes[t].lo), at(coarse, boxes[t].hi)}.count();
    const Cell lo = at(grid, boxes[t].lo), hi = at(grid, boxes[t].hi);
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

  const BucketGrid bucket_grid(grid);
  EXPECT_EQ(bucket_grid.bucket_bits() + bucket_grid.cell_bits(), grid.depth());
  partition(boxes, bucket_grid, records, buckets);
  EXPECT_EQ(buckets.record_begin.back(), records);
  std::vector<std::uint32_t> ids(refs.size());
  sort_buckets(bucket_grid, buckets, ids);
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

TEST(Buckets, EqualTheStableSortOfAllReferencesAtEveryDepth) {
  Buckets buckets;  // one for all: nothing may be left over from the build before
  for (const Box3& bounds :
       {Box3{{0, 0, 0}, {1, 1, 1}}, Box3{{0, 0, 0}, {1, 0, 20}}, Box3{{0, 0, 0}, {0, 1, 0}}}) {
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      for (int depth = 0; depth <= 30; depth += depth < 26 ? 3 : 1) {
        const Grid grid(bounds, axes, depth);
        SCOPED_TRACE(std::string(to_string(axes)) + " " + std::to_string(grid.depth()));
        expect_same(random_boxes(300, 1, 3), grid, buckets);
        expect_same(random_boxes(40, 2, depth < 20 ? 4000 : 300), grid, buckets);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(Buckets, KeepTheOrderAcrossChunks) {
  Buckets buckets;
  expect_same(random_boxes(50000, 3, 100), Grid({{0, 0, 0}, {1, 1, 1}}, AxisSchedule::cyclic, 17),
              buckets);
}

TEST(Buckets, SplitTheBitsSoThatRecordsFit) {
  for (int depth = 0; depth <= 30; ++depth) {
    const int cells = depth - BucketGrid::bucket_bits_of(depth);
    EXPECT_GE(BucketGrid::bucket_bits_of(depth), 0);
    EXPECT_LE(cells, 16) << "two corners in 32 bits";
    EXPECT_LE(BucketGrid::bucket_bits_of(depth), 14);
  }
}

}  // namespace
}  // namespace fasttree::build
