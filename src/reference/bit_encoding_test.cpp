// SPDX-License-Identifier: Apache-2.0
#include "reference/bit_encoding.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/meshes.h"

namespace fasttree::reference {
namespace {

TEST(BitEncoding, MarksAndRanksTheEssentialNodes) {
  test::Random random(1);
  std::set<std::uint32_t> marked;
  for (int i = 0; i < 500; ++i) marked.insert(random.below(1u << 12));
  InternalNodes nodes;
  nodes.node_index.assign(marked.begin(), marked.end());
  const EssentialBitmap bitmap = bit_encoding(nodes, 11);
  EXPECT_EQ(bitmap.words().size(), (1u << 12) / 32);
  std::uint32_t rank = 0;
  for (std::uint32_t index = 0; index < 1u << 12; ++index) {
    ASSERT_EQ(bitmap.essential(index), marked.contains(index));
    ASSERT_EQ(bitmap.rank(index), rank);
    if (marked.contains(index)) ++rank;
  }
}

TEST(BitEncoding, OfATreeOfDepthZeroHasOneWord) {
  EXPECT_EQ(EssentialBitmap(0).words().size(), 1u);
}

}  // namespace
}  // namespace fasttree::reference
