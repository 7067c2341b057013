// SPDX-License-Identifier: Apache-2.0
#include "reference/leaf_node.h"

#include <gtest/gtest.h>

namespace fasttree::reference {
namespace {

TEST(LeafNode, MakesALeafOfEveryRun) {
  References sorted;
  sorted.codes = {2, 2, 5, 7, 7, 7};
  sorted.ids = {0, 1, 1, 0, 2, 3};
  const LeafTable leaves = leaf_node(sorted);
  EXPECT_EQ(leaves.code, (std::vector<std::uint32_t>{2, 5, 7}));
  EXPECT_EQ(leaves.first, (std::vector<std::uint32_t>{0, 2, 3}));
  EXPECT_EQ(leaves.count, (std::vector<std::uint32_t>{2, 1, 3}));
}

TEST(LeafNode, OfNoReferencesIsEmpty) {
  EXPECT_EQ(leaf_node({}).size(), 0u);
}

}  // namespace
}  // namespace fasttree::reference
