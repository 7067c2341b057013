// SPDX-License-Identifier: Apache-2.0
#include "reference/internal_node.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/meshes.h"

namespace fasttree::reference {
namespace {

TEST(InternalNode, FindsTheHighestDifferentBit) {
  EXPECT_EQ(highest_different_bit(0b0110, 0b0111), 0);
  EXPECT_EQ(highest_different_bit(0b0011, 0b0100), 2);
  EXPECT_EQ(highest_different_bit(0, 1u << 31), 31);
}

TEST(InternalNode, IndexesTheLowestCommonAncestor) {
  // Two levels: codes 0..3, the root is 4, its children 2 and 6, the leaves 1, 3, 5, 7.
  EXPECT_EQ(leaf_node_index(2), 5u);
  EXPECT_EQ(ancestor_node_index(1, 0), 2u);
  EXPECT_EQ(ancestor_node_index(3, 0), 6u);
  EXPECT_EQ(ancestor_node_index(2, 1), 4u);
  EXPECT_EQ(ancestor_node_index(3, 1), 4u);
}

// All L - 1 are distinct and ascend: node j is the j-th essential node in order.
TEST(InternalNode, AscendInOrder) {
  test::Random random(1);
  std::set<std::uint32_t> codes;
  for (int i = 0; i < 3000; ++i) codes.insert(random.below(1u << 18));
  LeafTable leaves;
  leaves.code.assign(codes.begin(), codes.end());
  const Grid grid({{0, 0, 0}, {1, 2, 3}}, AxisSchedule::longest, 18);
  const InternalNodes nodes = internal_node(leaves, grid);
  ASSERT_EQ(nodes.size(), leaves.size() - 1);
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    // Between its two leaves in the order of the complete tree.
    EXPECT_LT(leaf_node_index(leaves.code[j]), nodes.node_index[j]);
    EXPECT_LT(nodes.node_index[j], leaf_node_index(leaves.code[j + 1]));
  }
}

}  // namespace
}  // namespace fasttree::reference
