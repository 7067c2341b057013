// SPDX-License-Identifier: Apache-2.0
#include "fasttree/device_image.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <functional>

#include "tree/test_trees.h"

namespace fasttree {
namespace {

constexpr std::uint32_t leaf(std::uint32_t j) {
  return kDeviceLeaf | j;
}

// Root at rank 1: leaves 0 and 1 below internal node 0, leaves 2 and 3 below internal node 2.
DeviceImage example() {
  DeviceImage image;
  image.info.depth = 2;
  image.info.bits = {1, 1, 0};
  image.info.triangle_count = 3;
  image.root = 1;
  image.leaves = {{0, 1}, {1, 2}, {3, 1}, {4, 1}};
  image.internal = {{leaf(0), leaf(1), 0.25f, 1}, {0, 2, 0.5f, 0}, {leaf(2), leaf(3), 0.75f, 1}};
  image.ids = {0, 0, 1, 2, 2};
  return image;
}

TEST(DeviceImage, BecomesTheTreeInPreOrder) {
  const Result<Tree> tree = tree_from_device_image(example());
  ASSERT_TRUE(tree.ok()) << tree.status().message();
  const std::vector<Node> expected{
      Node::inner(0, 0.5f, 4),  Node::inner(1, 0.25f, 3), Node::leaf(0, 1), Node::leaf(1, 2),
      Node::inner(1, 0.75f, 6), Node::leaf(3, 1),         Node::leaf(4, 1)};
  EXPECT_EQ(test::nodes_of(tree.value()), expected);
  EXPECT_EQ(test::ids_of(tree.value()), example().ids);
  EXPECT_EQ(tree.value().info(), example().info);
}

TEST(DeviceImage, ComesBackFromTheTree) {
  const Result<DeviceImage> image =
      device_image_from_tree(tree_from_device_image(example()).value());
  ASSERT_TRUE(image.ok()) << image.status().message();
  EXPECT_EQ(image.value(), example());
}

TEST(DeviceImage, OfTheEmptyTreeIsOneEmptyLeaf) {
  const Result<DeviceImage> image = device_image_from_tree(Tree());
  ASSERT_TRUE(image.ok());
  EXPECT_EQ(image.value().root, leaf(0));
  EXPECT_EQ(image.value().leaves, std::vector<DeviceLeaf>{DeviceLeaf()});
  EXPECT_TRUE(image.value().internal.empty());
  EXPECT_TRUE(test::same(tree_from_device_image(image.value()).value(), Tree()));
}

TEST(DeviceImage, ThereAndBackIsExactForTreesOfAnyShape) {
  ASSERT_TRUE(rc::check([](std::uint64_t seed) {
    test::Rng rng(seed);
    const Tree tree = test::random_shape(rng, *rc::gen::inRange<std::uint32_t>(1, 300));
    const Result<DeviceImage> image = device_image_from_tree(tree);
    RC_ASSERT(image.ok());
    const Result<Tree> again = tree_from_device_image(image.value());
    RC_ASSERT(again.ok());
    RC_ASSERT(test::same(again.value(), tree));
    RC_ASSERT(again.value().hash() == tree.hash());
    RC_ASSERT(device_image_from_tree(again.value()).value() == image.value());
  }));
}

// The formula against the plain recursion it replaces.
TEST(DeviceImage, PositionsAreThoseOfADepthFirstWalk) {
  test::Rng rng(7);
  const DeviceImage image = device_image_from_tree(test::random_shape(rng, 200)).value();
  std::vector<Node> walked;
  const std::function<void(std::uint32_t)> walk = [&](std::uint32_t child) {
    if (child & kDeviceLeaf) {
      const DeviceLeaf& run = image.leaves[child & ~kDeviceLeaf];
      walked.push_back(Node::leaf(run.first, run.count));
      return;
    }
    const DeviceInternalNode& node = image.internal[child];
    const std::size_t at = walked.size();
    walked.push_back({});
    walk(node.lower);
    walked[at] = Node::inner(node.axis, node.split, static_cast<std::uint32_t>(walked.size()));
    walk(node.upper);
  };
  walk(image.root);
  EXPECT_EQ(test::nodes_of(tree_from_device_image(image).value()), walked);
}

// A chain to either side, far deeper than a call stack would bear.
TEST(DeviceImage, DeepTreesAreNoTrouble) {
  constexpr std::uint32_t kLeaves = 1'000'000;
  for (const bool to_lower : {true, false}) {
    DeviceImage image;
    image.leaves.resize(kLeaves);
    image.internal.resize(kLeaves - 1);
    image.root = to_lower ? kLeaves - 2 : 0;
    for (std::uint32_t j = 0; j + 1 < kLeaves; ++j) {
      image.internal[j].lower = to_lower && j > 0 ? j - 1 : leaf(j);
      image.internal[j].upper = !to_lower && j + 2 < kLeaves ? j + 1 : leaf(j + 1);
    }
    const Result<Tree> tree = tree_from_device_image(image);
    ASSERT_TRUE(tree.ok()) << tree.status().message();
    EXPECT_EQ(tree.value().nodes().size(), 2 * kLeaves - 1);
    EXPECT_EQ(device_image_from_tree(tree.value()).value(), image);
  }
}

struct BrokenImage {
  const char* name;
  std::function<void(DeviceImage&)> damage;
  const char* message;
};

TEST(DeviceImage, BrokenOnesAreRefusedByName) {
  const BrokenImage cases[] = {
      {"no leaf", [](DeviceImage& i) { i.leaves.clear(); }, "no leaf"},
      {"too few internal", [](DeviceImage& i) { i.internal.pop_back(); },
       "4 leaves go with 3 internal nodes, not 2"},
      {"too many internal", [](DeviceImage& i) { i.internal.push_back({}); }, "not 4"},
      {"run behind the ids",
       [](DeviceImage& i) {
         i.leaves[3] = {5, 1};
       },
       "leaf 3"},
      {"run too long", [](DeviceImage& i) { i.leaves[1].count = 5; }, "leaf 1"},
      {"run that overflows",
       [](DeviceImage& i) {
         i.leaves[2] = {0xffffffffu, 2};
       },
       "leaf 2"},
      {"axis 3", [](DeviceImage& i) { i.internal[2].axis = 3; }, "internal node 2 splits axis 3"},
      {"root out of range", [](DeviceImage& i) { i.root = 3; }, "the root is internal node 3"},
      {"root a leaf", [](DeviceImage& i) { i.root = leaf(0); }, "the root is leaf 0"},
      {"cycle to the root", [](DeviceImage& i) { i.internal[0].lower = 1; },
       "internal node 0 has internal node 1 as its lower child"},
      {"itself", [](DeviceImage& i) { i.internal[2].upper = 2; },
       "internal node 2 has internal node 2 as its upper child"},
      {"leaf twice", [](DeviceImage& i) { i.internal[2].upper = leaf(2); },
       "internal node 2 has leaf 2 as its upper child, where leaves 3 to 3 belong"},
      {"leaf out of range", [](DeviceImage& i) { i.internal[2].upper = leaf(4); }, "leaf 4"},
      {"leaves out of order",
       [](DeviceImage& i) { std::swap(i.internal[0].lower, i.internal[0].upper); },
       "internal node 0 has leaf 1 as its lower child"},
      {"subtrees swapped",
       [](DeviceImage& i) { std::swap(i.internal[1].lower, i.internal[1].upper); },
       "internal node 1 has internal node 2 as its lower child"},
      {"subtree dropped", [](DeviceImage& i) { i.internal[1].upper = leaf(2); },
       "internal node 1 has leaf 2 as its upper child, where leaves 2 to 3 belong"},
  };
  for (const BrokenImage& c : cases) {
    DeviceImage image = example();
    c.damage(image);
    const Result<Tree> tree = tree_from_device_image(image);
    ASSERT_FALSE(tree.ok()) << c.name;
    EXPECT_EQ(tree.status().code(), StatusCode::bad_input) << c.name;
    EXPECT_NE(tree.status().message().find(c.message), std::string::npos)
        << c.name << ": " << tree.status().message();
  }
}

TEST(DeviceImage, WhateverIsAcceptedIsExact) {
  test::Rng rng(11);
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    DeviceImage image =
        device_image_from_tree(test::random_shape(rng, 2 + test::below(rng, 6))).value();
    const auto children = static_cast<std::uint32_t>(image.internal.size());
    for (std::uint32_t changes = 1 + test::below(rng, 2); changes > 0; --changes) {
      DeviceInternalNode& node = image.internal[test::below(rng, children)];
      std::uint32_t& link = test::below(rng, 2) ? node.lower : node.upper;
      link = test::below(rng, children + 2) | (test::below(rng, 2) ? kDeviceLeaf : 0);
    }
    const Result<Tree> tree = tree_from_device_image(image);
    if (!tree.ok()) continue;
    ++accepted;
    ASSERT_EQ(device_image_from_tree(tree.value()).value(), image);
  }
  EXPECT_GT(accepted, 100);
}

TEST(DeviceImage, TreesWithBrokenLinksAreRefused) {
  const Tree good = tree_from_device_image(example()).value();
  const auto refused = [&](const std::function<void(std::vector<Node>&)>& damage) {
    std::vector<Node> nodes = test::nodes_of(good);
    damage(nodes);
    const Result<DeviceImage> image =
        device_image_from_tree(Tree(good.info(), nodes, test::ids_of(good)));
    EXPECT_FALSE(image.ok());
    EXPECT_EQ(image.status().code(), StatusCode::bad_input);
    return image.status().message();
  };
  using Nodes = std::vector<Node>;
  EXPECT_NE(refused([](Nodes& n) { n.clear(); }).find("no node"), std::string::npos);
  EXPECT_NE(refused([](Nodes& n) { n[0] = Node::inner(0, 0.5f, 5); }).find("node 0 has its upper"),
            std::string::npos);
  EXPECT_NE(refused([](Nodes& n) { n[1] = Node::inner(1, 0.5f, 0xfffffff); }).find("node 1"),
            std::string::npos);
  EXPECT_NE(refused([](Nodes& n) { n.push_back(Node::leaf(0, 0)); }).find("node 7 belongs to no"),
            std::string::npos);
  EXPECT_NE(refused([](Nodes& n) { n.pop_back(); }).find("node 4 has no upper child"),
            std::string::npos);
}

}  // namespace
}  // namespace fasttree
