// SPDX-License-Identifier: Apache-2.0
#include "trace/traversal.h"

#include <gtest/gtest.h>

#include <vector>

namespace fasttree {
namespace {

const Box3 kUnit{{0, 0, 0}, {1, 1, 1}};

// One split of the unit box at x = 0.5: node 0, leaves 1 (lower) and 2 (upper).
const std::vector<Node> kTwoLeaves{Node::inner(0, 0.5f, 2), Node::leaf(0, 1), Node::leaf(1, 1)};

std::vector<std::uint32_t> visited(const Ray& ray, TraceCounters* counters = nullptr,
                                   float stop_at = -1) {
  std::vector<std::uint32_t> firsts;
  traverse(kTwoLeaves, kUnit, ray, counters, [&](const Node& node, float& nearest) {
    firsts.push_back(node.first());
    if (stop_at >= 0) nearest = stop_at;
    return false;
  });
  return firsts;
}

using Order = std::vector<std::uint32_t>;

TEST(Traversal, GoesFrontToBackByTheSignOfTheDirection) {
  EXPECT_EQ(visited({{-1, 0.5f, 0.5f}, 0, {1, 0, 0}}), (Order{0, 1}));
  EXPECT_EQ(visited({{2, 0.5f, 0.5f}, 0, {-1, 0, 0}}), (Order{1, 0}));
  EXPECT_EQ(visited({{0.2f, -1, 0.5f}, 0, {0, 1, 0}}), (Order{0}));
  EXPECT_EQ(visited({{0.8f, -1, 0.5f}, 0, {-0.0f, 1, 0}}), (Order{1}));
}

TEST(Traversal, ARayInThePlaneGoesToTheUpperCellFirst) {
  EXPECT_EQ(visited({{0.5f, -1, 0.5f}, 0, {0, 1, 0}}), (Order{1, 0}));
}

TEST(Traversal, MissesWhatItCannotReach) {
  EXPECT_EQ(visited({{-1, 2, 0.5f}, 0, {1, 0, 0}}), Order{});
  EXPECT_EQ(visited({{-1, 0.5f, 0.5f}, 0, {-1, 0, 0}}), Order{}) << "behind";
  Ray shorter{{-1, 0.5f, 0.5f}, 0, {1, 0, 0}};
  shorter.t_max = 1.2f;
  EXPECT_EQ(visited(shorter), (Order{0}));
  shorter.t_max = 0.5f;
  EXPECT_EQ(visited(shorter), Order{});
  Ray later{{-1, 0.5f, 0.5f}, 1.7f, {1, 0, 0}};
  EXPECT_EQ(visited(later), (Order{1}));
}

TEST(Traversal, VisitsBothSidesWhereTheIntervalEndsAtThePlane) {
  Ray ray{{-1, 0.5f, 0.5f}, 0, {1, 0, 0}};
  ray.t_max = 1.5f;
  EXPECT_EQ(visited(ray), (Order{0, 1}));
  ray.t_max = 10;
  ray.t_min = 1.5f;
  EXPECT_EQ(visited(ray), (Order{0, 1}));
}

TEST(Traversal, EndsWhenTheNextSideBeginsBeyondTheNearestHit) {
  const Ray ray{{-1, 0.5f, 0.5f}, 0, {1, 0, 0}};
  EXPECT_EQ(visited(ray, nullptr, 1.4f), (Order{0}));
  EXPECT_EQ(visited(ray, nullptr, 1.5f), (Order{0, 1})) << "an equal t may have a lower id";
}

TEST(Traversal, CountsStepsLeavesAndTests) {
  TraceCounters counters;
  visited({{-1, 0.5f, 0.5f}, 0, {1, 0, 0}}, &counters);
  EXPECT_EQ(counters.inner_steps, 1u);
  EXPECT_EQ(counters.leaf_visits, 2u);
  EXPECT_EQ(counters.triangle_tests, 2u);
}

}  // namespace
}  // namespace fasttree
