// SPDX-License-Identifier: Apache-2.0
#include "fasttree/quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace fasttree {
namespace {

TreeInfo info_for(const Box3& bounds, std::uint32_t triangles) {
  TreeInfo info;
  info.bounds = bounds;
  info.triangle_count = triangles;
  return info;
}

TEST(Quality, TreeOfAnEmptyMesh) {
  const Quality q = measure_quality(Tree());
  EXPECT_EQ(q.nodes, 1u);
  EXPECT_EQ(q.inner_nodes, 0u);
  EXPECT_EQ(q.leaves, 1u);
  EXPECT_EQ(q.empty_leaves, 1u);
  EXPECT_EQ(q.references, 0u);
  EXPECT_EQ(q.references_per_triangle, 0.0);
  EXPECT_EQ(q.max_depth, 0u);
  EXPECT_EQ(q.mean_leaf_depth, 0.0);
  EXPECT_EQ(q.max_leaf_size, 0u);
  EXPECT_EQ(q.mean_leaf_size, 0.0);
  EXPECT_EQ(q.leaf_size_histogram, std::vector<std::uint64_t>{1});
  EXPECT_EQ(q.expected_inner_steps, 0.0);
  EXPECT_EQ(q.expected_leaf_visits, 1.0);
  EXPECT_EQ(q.expected_triangle_tests, 0.0);
  EXPECT_EQ(q.sah_cost, 0.0);
}

TEST(Quality, TreeOfTwoSplits) {
  // A box of 4 x 2 x 2, halved at x = 1, its upper part at y = 1.
  // Areas: root 2 (8 + 4 + 8) = 40; [0,1]x2x2: 2 (2 + 4 + 2) = 16; [1,4]x2x2: 2 (6 + 4 + 6) = 32;
  // [1,4]x[0,1]x2 and [1,4]x[1,2]x2: 2 (3 + 2 + 6) = 22.
  const std::vector<Node> nodes{Node::inner(0, 1.0f, 2), Node::leaf(0, 5), Node::inner(1, 1.0f, 4),
                                Node::leaf(5, 0), Node::leaf(5, 2)};
  const Tree tree(info_for({{0, 0, 0}, {4, 2, 2}}, 6), nodes, {0, 1, 2, 3, 4, 4, 5});
  const Quality q = measure_quality(tree, {2.0, 3.0});
  EXPECT_EQ(q.nodes, 5u);
  EXPECT_EQ(q.inner_nodes, 2u);
  EXPECT_EQ(q.leaves, 3u);
  EXPECT_EQ(q.empty_leaves, 1u);
  EXPECT_EQ(q.references, 7u);
  EXPECT_DOUBLE_EQ(q.references_per_triangle, 7.0 / 6.0);
  EXPECT_EQ(q.max_depth, 2u);
  EXPECT_DOUBLE_EQ(q.mean_leaf_depth, (1 + 2 + 2) / 3.0);
  EXPECT_EQ(q.max_leaf_size, 5u);
  EXPECT_DOUBLE_EQ(q.mean_leaf_size, 3.5);
  EXPECT_EQ(q.leaf_size_histogram, (std::vector<std::uint64_t>{1, 0, 1, 0, 1}));
  EXPECT_DOUBLE_EQ(q.expected_inner_steps, 1 + 32.0 / 40);
  EXPECT_DOUBLE_EQ(q.expected_leaf_visits, (16.0 + 22.0 + 22.0) / 40);
  EXPECT_DOUBLE_EQ(q.expected_triangle_tests, (5 * 16.0 + 2 * 22.0) / 40);
  EXPECT_DOUBLE_EQ(q.sah_cost, 2 * q.expected_inner_steps + 3 * q.expected_triangle_tests);
}

TEST(Quality, DefaultCostsAreThoseOfWaldAndHavran) {
  const std::vector<Node> nodes{Node::inner(0, 0.5f, 2), Node::leaf(0, 1), Node::leaf(1, 0)};
  const Quality q = measure_quality(Tree(info_for({{0, 0, 0}, {1, 1, 1}}, 1), nodes, {0}));
  EXPECT_DOUBLE_EQ(q.sah_cost, 15 * 1 + 20 * (2 * (0.5 + 1 + 0.5)) / 6);
}

TEST(Quality, HistogramDoublesItsBuckets) {
  // A chain of leaves with 0 to 9 triangles: one each of 0, 1, 2; 3 and 4; 5 to 8; 9.
  std::vector<Node> nodes;
  std::vector<std::uint32_t> ids;
  for (std::uint32_t count = 0; count < 10; ++count) {
    const auto index = static_cast<std::uint32_t>(nodes.size());
    if (count < 9) nodes.push_back(Node::inner(0, static_cast<float>(count + 1), index + 2));
    nodes.push_back(Node::leaf(static_cast<std::uint32_t>(ids.size()), count));
    for (std::uint32_t i = 0; i < count; ++i) ids.push_back(i);
  }
  const Quality q = measure_quality(Tree(info_for({{0, 0, 0}, {10, 1, 1}}, 9), nodes, ids));
  EXPECT_EQ(q.leaf_size_histogram, (std::vector<std::uint64_t>{1, 1, 1, 2, 4, 1}));
  EXPECT_EQ(q.max_depth, 9u);
  EXPECT_DOUBLE_EQ(q.mean_leaf_depth, (1 + 2 + 3 + 4 + 5 + 6 + 7 + 8 + 9 + 9) / 10.0);
}

TEST(Quality, BoundsWithoutAnArea) {
  const std::vector<Node> nodes{Node::inner(0, 1.0f, 2), Node::leaf(0, 2), Node::leaf(2, 1)};
  const std::vector<std::uint32_t> ids{0, 1, 1};
  // Flat: the area of both sides, here 4 x 2.
  Quality q = measure_quality(Tree(info_for({{0, 0, 3}, {4, 2, 3}}, 2), nodes, ids));
  EXPECT_DOUBLE_EQ(q.expected_triangle_tests, (2 * 2.0 + 1 * 6.0) / 8);
  // A segment: by length.
  q = measure_quality(Tree(info_for({{0, 2, 3}, {4, 2, 3}}, 2), nodes, ids));
  EXPECT_DOUBLE_EQ(q.expected_triangle_tests, (2 * 1.0 + 1 * 3.0) / 4);
  EXPECT_DOUBLE_EQ(q.expected_inner_steps, 1.0);
  // A point: every node counts as met.
  q = measure_quality(Tree(info_for({{1, 2, 3}, {1, 2, 3}}, 2), nodes, ids));
  EXPECT_DOUBLE_EQ(q.expected_triangle_tests, 3.0);
  EXPECT_DOUBLE_EQ(q.expected_leaf_visits, 2.0);
}

TEST(Quality, ExtremeBoundsGiveTheSameFigures) {
  const std::vector<std::uint32_t> ids{0, 1, 1};
  double expected = -1;
  for (const float scale : {1.0f, 0x1p127f, 0x1p-140f}) {
    const std::vector<Node> nodes{Node::inner(0, 0.5f * scale, 2), Node::leaf(0, 2),
                                  Node::leaf(2, 1)};
    const Box3 bounds{{-scale, -scale, -scale}, {scale, scale, scale}};
    const Quality q = measure_quality(Tree(info_for(bounds, 2), nodes, ids));
    ASSERT_TRUE(std::isfinite(q.sah_cost));
    if (expected < 0) expected = q.sah_cost;
    EXPECT_DOUBLE_EQ(q.sah_cost, expected);
  }
}

/// A random tree over `bounds`; leaves with 0 to 5 triangles.
class RandomTree {
 public:
  explicit RandomTree(std::uint32_t seed) : rng_(seed) { node({{0, 0, 0}, {3, 1, 2}}, 0); }

  Tree tree() const { return Tree(info_for({{0, 0, 0}, {3, 1, 2}}, 5), nodes_, ids_); }

 private:
  void node(const Box3& cell, int depth) {
    std::uniform_real_distribution<float> share(0.2f, 0.8f);
    const std::size_t index = nodes_.size();
    if (depth >= 8 || (depth > 2 && rng_() % 6 == 0)) {
      const auto count = static_cast<std::uint32_t>(rng_() % 6);
      nodes_.push_back(Node::leaf(static_cast<std::uint32_t>(ids_.size()), count));
      for (std::uint32_t i = 0; i < count; ++i) ids_.push_back(i);
      return;
    }
    const auto axis = static_cast<std::uint32_t>(rng_() % 3);
    const float split = cell.lo[axis] + share(rng_) * (cell.hi[axis] - cell.lo[axis]);
    Box3 lower = cell, upper = cell;
    lower.hi[axis] = split;
    upper.lo[axis] = split;
    nodes_.push_back({});
    node(lower, depth + 1);
    nodes_[index] = Node::inner(axis, split, static_cast<std::uint32_t>(nodes_.size()));
    node(upper, depth + 1);
  }

  std::mt19937 rng_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> ids_;
};

struct Line {
  std::array<double, 3> origin{};
  std::array<double, 3> direction{};
};

/// A line from the uniform, isotropic measure over lines that meet a ball round the bounds.
Line random_line(std::mt19937_64& rng, const Box3& bounds) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const auto normalised = [](std::array<double, 3> v) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (double& c : v) c /= length;
    return v;
  };
  Line line;
  line.direction = normalised({normal(rng), normal(rng), normal(rng)});
  const auto& d = line.direction;
  // A point of the disc through the centre, at right angles to the direction.
  const std::array<double, 3> help =
      std::abs(d[0]) < 0.5 ? std::array<double, 3>{1, 0, 0} : std::array<double, 3>{0, 1, 0};
  const auto u = normalised({d[1] * help[2] - d[2] * help[1], d[2] * help[0] - d[0] * help[2],
                             d[0] * help[1] - d[1] * help[0]});
  const std::array<double, 3> v{d[1] * u[2] - d[2] * u[1], d[2] * u[0] - d[0] * u[2],
                                d[0] * u[1] - d[1] * u[0]};
  double radius = 0;
  for (std::size_t a = 0; a < 3; ++a) radius += std::pow(bounds.hi[a] - bounds.lo[a], 2) / 4;
  const double r = std::sqrt(radius * unit(rng));
  const double angle = 2 * 3.14159265358979323846 * unit(rng);
  for (std::size_t a = 0; a < 3; ++a) {
    line.origin[a] = (double{bounds.lo[a]} + bounds.hi[a]) / 2 +
                     r * (std::cos(angle) * u[a] + std::sin(angle) * v[a]);
  }
  return line;
}

bool meets(const Line& line, const Box3& box) {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = -enter;
  for (std::size_t a = 0; a < 3; ++a) {
    double t0 = (box.lo[a] - line.origin[a]) / line.direction[a];
    double t1 = (box.hi[a] - line.origin[a]) / line.direction[a];
    if (t0 > t1) std::swap(t0, t1);
    enter = std::max(enter, t0);
    leave = std::min(leave, t1);
  }
  return enter < leave;
}

struct Met {
  std::uint64_t inner = 0, leaves = 0, triangles = 0;
};

void walk(const Tree& tree, std::uint32_t index, const Box3& cell, const Line& line, Met& met) {
  if (!meets(line, cell)) return;
  const Node node = tree.nodes()[index];
  if (node.is_leaf()) {
    ++met.leaves;
    met.triangles += node.count();
    return;
  }
  ++met.inner;
  Box3 lower = cell, upper = cell;
  lower.hi[node.axis()] = node.split();
  upper.lo[node.axis()] = node.split();
  walk(tree, index + 1, lower, line, met);
  walk(tree, node.upper(), upper, line, met);
}

TEST(Quality, ExpectedValuesAreWhatRandomLinesMeet) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const Tree tree = RandomTree(seed).tree();
    const Quality q = measure_quality(tree);
    ASSERT_GT(q.leaves, 20u);
    std::mt19937_64 rng(seed);
    Met met;
    std::uint64_t lines = 0;
    while (lines < 100'000) {
      const Line line = random_line(rng, tree.info().bounds);
      if (!meets(line, tree.info().bounds)) continue;
      ++lines;
      walk(tree, 0, tree.info().bounds, line, met);
    }
    const auto n = static_cast<double>(lines);
    // The standard error of these means is about 0.3 per cent.
    EXPECT_NEAR(static_cast<double>(met.inner) / n, q.expected_inner_steps,
                0.015 * q.expected_inner_steps);
    EXPECT_NEAR(static_cast<double>(met.leaves) / n, q.expected_leaf_visits,
                0.015 * q.expected_leaf_visits);
    EXPECT_NEAR(static_cast<double>(met.triangles) / n, q.expected_triangle_tests,
                0.015 * q.expected_triangle_tests);
  }
}

}  // namespace
}  // namespace fasttree
