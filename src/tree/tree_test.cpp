// SPDX-License-Identifier: Apache-2.0
#include "fasttree/tree.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "tree/test_trees.h"
#include "tree/xxh3.h"

namespace fasttree {
namespace {

Tree small_tree() {
  TreeInfo info;
  info.depth = 1;
  info.bits = {1, 0, 0};
  info.triangle_count = 2;
  info.bounds = {{-1, -2, -3}, {1, 2, 3}};
  return Tree(info, {Node::inner(0, 0.5f, 2), Node::leaf(0, 1), Node::leaf(1, 2)}, {0, 0, 1});
}

TEST(Tree, NodeFieldsShareTheirWordsAsDocumented) {
  const Node inner = Node::inner(2, 1.0f, 5);
  EXPECT_EQ(inner.word0, 5u << 2 | 2);
  EXPECT_EQ(inner.word1, 0x3f800000u);
  EXPECT_FALSE(inner.is_leaf());
  EXPECT_EQ(inner.axis(), 2u);
  EXPECT_EQ(inner.upper(), 5u);
  EXPECT_EQ(inner.split(), 1.0f);
  const Node leaf = Node::leaf(7, (1u << 30) - 1);
  EXPECT_EQ(leaf.word0, 0xffffffffu);
  EXPECT_TRUE(leaf.is_leaf());
  EXPECT_EQ(leaf.first(), 7u);
  EXPECT_EQ(leaf.count(), (1u << 30) - 1);
}

TEST(Tree, EmptyTreeIsOneLeafWithoutTriangles) {
  const Tree tree;
  ASSERT_EQ(tree.nodes().size(), 1u);
  EXPECT_EQ(tree.nodes()[0], Node::leaf(0, 0));
  EXPECT_TRUE(tree.ids().empty());
  EXPECT_EQ(tree.leaf_count(), 1u);
  EXPECT_EQ(tree.info(), TreeInfo());
}

TEST(Tree, HashIsThatOfTheBytesInOrder) {
  const Tree tree = small_tree();
  const std::array<float, 6> bounds{-1, -2, -3, 1, 2, 3};
  std::array<std::byte, 24 + 3 * 8 + 3 * 4> all{};
  std::memcpy(all.data(), bounds.data(), 24);
  std::memcpy(all.data() + 24, tree.nodes().data(), 24);
  std::memcpy(all.data() + 48, tree.ids().data(), 12);
  EXPECT_EQ(tree.hash(), XXH3_64bits(all.data(), all.size()));
}

// Pinned: the hash is written in files and in others' records, so it must never drift.
TEST(Tree, HashOfKnownTreesStays) {
  EXPECT_EQ(hash_string(Tree().hash()), "90620b406b8028cb");
  EXPECT_EQ(hash_string(small_tree().hash()), "f2bff971707edcac");
}

TEST(Tree, HashSeesEveryBitOfBoundsNodesAndIds) {
  const Tree tree = small_tree();
  const std::uint64_t hash = tree.hash();
  for (std::size_t bit = 0; bit < 32; ++bit) {
    const std::uint32_t flip = 1u << bit;
    for (std::size_t i = 0; i < 3; ++i) {
      auto nodes = test::nodes_of(tree);
      nodes[i].word0 ^= flip;
      EXPECT_NE(Tree(tree.info(), nodes, test::ids_of(tree)).hash(), hash);
      nodes = test::nodes_of(tree);
      nodes[i].word1 ^= flip;
      EXPECT_NE(Tree(tree.info(), nodes, test::ids_of(tree)).hash(), hash);
      auto ids = test::ids_of(tree);
      ids[i] ^= flip;
      EXPECT_NE(Tree(tree.info(), test::nodes_of(tree), ids).hash(), hash);
      TreeInfo info = tree.info();
      info.bounds.lo[i] =
          std::bit_cast<float>(std::bit_cast<std::uint32_t>(info.bounds.lo[i]) ^ flip);
      EXPECT_NE(Tree(info, test::nodes_of(tree), test::ids_of(tree)).hash(), hash);
    }
  }
}

TEST(Tree, HashLeavesOutWhatBuildersMayDifferIn) {
  const Tree tree = small_tree();
  TreeInfo info = tree.info();
  info.profile = Profile::sah_exact;
  info.axes = AxisSchedule::longest;
  EXPECT_EQ(Tree(info, test::nodes_of(tree), test::ids_of(tree)).hash(), tree.hash());
}

TEST(Tree, HashStringHasSixteenDigits) {
  EXPECT_EQ(hash_string(0), "0000000000000000");
  EXPECT_EQ(hash_string(0x0123456789abcdefu), "0123456789abcdef");
  EXPECT_EQ(hash_string(~std::uint64_t{0}), "ffffffffffffffff");
}

TEST(Tree, SettingsHaveNames) {
  EXPECT_STREQ(to_string(AxisSchedule::cyclic), "cyclic");
  EXPECT_STREQ(to_string(AxisSchedule::longest), "longest");
  EXPECT_STREQ(to_string(static_cast<AxisSchedule>(9)), "unknown");
  EXPECT_STREQ(to_string(Profile::paper), "paper");
  EXPECT_STREQ(to_string(Profile::sah_exact), "sah-exact");
  EXPECT_STREQ(to_string(Profile::sah_binned), "sah-binned");
  EXPECT_STREQ(to_string(static_cast<Profile>(9)), "unknown");
}

TEST(Tree, CopiesOfOwnedTreesAreDeep) {
  const Tree tree = small_tree();
  const Tree copy = tree;
  EXPECT_TRUE(test::same(tree, copy));
  EXPECT_NE(tree.nodes().data(), copy.nodes().data());
}

TEST(Tree, ReleaseLeavesTheEmptyTree) {
  Tree tree = small_tree();
  EXPECT_EQ(tree.release(), nullptr);
  EXPECT_TRUE(test::same(tree, Tree()));
}

TEST(Tree, ViewsKeepTheirOwnerAndCopiesShareIt) {
  struct Arrays {
    std::vector<Node> nodes;
    std::vector<std::uint32_t> ids;
  };
  const Tree owned = small_tree();
  auto arrays = std::make_shared<const Arrays>(Arrays{test::nodes_of(owned), test::ids_of(owned)});
  const std::weak_ptr<const Arrays> watch = arrays;
  Tree view(owned.info(), arrays->nodes, arrays->ids, arrays);
  arrays.reset();
  EXPECT_TRUE(test::same(view, owned));
  EXPECT_EQ(view.hash(), owned.hash());

  Tree copy = view;
  EXPECT_EQ(copy.nodes().data(), view.nodes().data());
  EXPECT_EQ(view.release(), watch.lock());
  EXPECT_TRUE(test::same(view, Tree()));
  EXPECT_TRUE(test::same(copy, owned));
  EXPECT_FALSE(watch.expired());
  copy = Tree();
  EXPECT_TRUE(watch.expired());
}

}  // namespace
}  // namespace fasttree
