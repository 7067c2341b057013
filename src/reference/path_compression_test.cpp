// SPDX-License-Identifier: Apache-2.0
#include "reference/path_compression.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/meshes.h"

namespace fasttree::reference {
namespace {

TEST(PathCompression, ClimbsTheCompleteTree) {
  // Three levels: leaf cell 5 has index 11 = 1011b, its parent 10, then 12, then the root 8.
  EXPECT_EQ(climb(11).parent, 10u);
  EXPECT_TRUE(climb(11).upper_child);
  EXPECT_EQ(climb(10).parent, 12u);
  EXPECT_FALSE(climb(10).upper_child);
  EXPECT_EQ(climb(12).parent, 8u);
  EXPECT_TRUE(climb(12).upper_child);
}

struct Built {
  LeafTable leaves;
  InternalNodes nodes;
  Links links;
};

Built compress(const std::set<std::uint32_t>& codes, int depth) {
  Built b;
  b.leaves.code.assign(codes.begin(), codes.end());
  const Grid grid({{0, 0, 0}, {1, 1, 1}}, AxisSchedule::cyclic, depth);
  b.nodes = internal_node(b.leaves, grid);
  b.links = path_compression(b.leaves, b.nodes, bit_encoding(b.nodes, depth), depth);
  return b;
}

TEST(PathCompression, OfOneLeafIsTheLeaf) {
  const Built b = compress({5}, 3);
  EXPECT_EQ(b.links.root, kDeviceLeaf | 0u);
  EXPECT_EQ(b.links.leaf_parent, (std::vector<std::uint32_t>{kNoParent}));
}

TEST(PathCompression, SkipsSplitsWithAnEmptySide) {
  // Codes 000, 001 and 111: the node over the first two hangs under the root directly.
  const Built b = compress({0, 1, 7}, 3);
  EXPECT_EQ(b.nodes.node_index, (std::vector<std::uint32_t>{2, 8}));
  EXPECT_EQ(b.links.root, 1u);
  EXPECT_EQ(b.links.lower, (std::vector<std::uint32_t>{kDeviceLeaf | 0, 0}));
  EXPECT_EQ(b.links.upper, (std::vector<std::uint32_t>{kDeviceLeaf | 1, kDeviceLeaf | 2}));
  EXPECT_EQ(b.links.internal_parent, (std::vector<std::uint32_t>{1, kNoParent}));
}

// Judge: a recursive construction that splits the sorted codes at their highest different bit.
std::uint32_t split_recursively(const LeafTable& leaves, std::uint32_t first, std::uint32_t last,
                                const Links& links) {
  if (first == last) return first | kDeviceLeaf;
  const int m = highest_different_bit(leaves.code[first], leaves.code[last]);
  std::uint32_t j = first;
  while (!(leaves.code[j + 1] >> m & 1u)) ++j;
  EXPECT_EQ(links.lower[j], split_recursively(leaves, first, j, links));
  EXPECT_EQ(links.upper[j], split_recursively(leaves, j + 1, last, links));
  return j;
}

TEST(PathCompression, EqualsARecursiveConstruction) {
  test::Random random(9);
  for (const int depth : {1, 2, 3, 5, 10, 15, 21}) {
    for (const int wanted : {1, 2, 3, 10, 300}) {
      std::set<std::uint32_t> codes;
      for (int i = 0; i < wanted; ++i) codes.insert(random.below(1u << depth));
      const Built b = compress(codes, depth);
      const auto last = static_cast<std::uint32_t>(b.leaves.size() - 1);
      EXPECT_EQ(b.links.root, split_recursively(b.leaves, 0, last, b.links));
      // Children and parents agree.
      for (std::uint32_t j = 0; j < b.nodes.size(); ++j) {
        for (const std::uint32_t child : {b.links.lower[j], b.links.upper[j]}) {
          const std::uint32_t parent = child & kDeviceLeaf
                                           ? b.links.leaf_parent[child & ~kDeviceLeaf]
                                           : b.links.internal_parent[child];
          EXPECT_EQ(parent, j);
        }
      }
    }
  }
}

}  // namespace
}  // namespace fasttree::reference
