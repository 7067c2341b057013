// SPDX-License-Identifier: Apache-2.0
// What both yardstick builders promise: form, coverage, quality, limits, cancelling.
#include "baseline/baseline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "baseline/test_meshes.h"

namespace fasttree::baseline {
namespace {

using testing::build;
using testing::check_structure;
using testing::NodeCell;
using testing::Soup;
using testing::Which;

using Point = std::array<double, 3>;

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Do triangle and box have a common point? By separating axes (Akenine-Moeller 2001), nothing in
/// common with the clipping of the builders. `margin` grows the box, or shrinks it where negative.
bool overlap(const std::array<Vec3, 3>& triangle, const Box3& box, double margin) {
  Point centre, half;
  for (std::size_t a = 0; a < 3; ++a) {
    centre[a] = (double{box.lo[a]} + box.hi[a]) / 2;
    half[a] = (double{box.hi[a]} - box.lo[a]) / 2 + margin;
    if (half[a] < 0) return false;
  }
  std::array<Point, 3> v;
  for (std::size_t i = 0; i < 3; ++i) {
    v[i] = minus({triangle[i].x, triangle[i].y, triangle[i].z}, centre);
  }
  const std::array<Point, 3> edges{minus(v[1], v[0]), minus(v[2], v[1]), minus(v[0], v[2])};
  std::vector<Point> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, cross(edges[0], edges[1])};
  for (const Point& e : edges) {
    axes.push_back({0, -e[2], e[1]});
    axes.push_back({e[2], 0, -e[0]});
    axes.push_back({-e[1], e[0], 0});
  }
  for (const Point& n : axes) {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const Point& p : v) {
      const double d = n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
      lo = std::min(lo, d);
      hi = std::max(hi, d);
    }
    const double r = half[0] * std::abs(n[0]) + half[1] * std::abs(n[1]) + half[2] * std::abs(n[2]);
    if (lo > r || hi < -r) return false;
  }
  return true;
}

/// Every leaf has exactly the triangles that reach it. Triangles that only touch it may be there or
/// not, and bounds rounded outward may add some that are one binary32 step away.
void check_leaves_exactly(const Soup& soup, Which which) {
  double scale = 0;
  for (const Vec3& p : soup.positions) {
    for (std::size_t a = 0; a < 3; ++a) scale = std::max(scale, std::abs(double{p[a]}));
  }
  const double step = 1.2e-7 * scale;
  const double rounding = 1e-10 * scale;
  const Result<Tree> result = build(soup, which);
  ASSERT_TRUE(result.ok());
  const Tree& tree = result.value();
  const std::vector<NodeCell> cells = check_structure(tree, soup, which);
  for (std::size_t i = 0; i < tree.nodes().size(); ++i) {
    const Node node = tree.nodes()[i];
    if (!node.is_leaf()) continue;
    const auto ids = tree.ids().subspan(node.first(), node.count());
    for (std::uint32_t t = 0; t < soup.size(); ++t) {
      const auto triangle = soup.view().triangle(t);
      const bool there = std::binary_search(ids.begin(), ids.end(), t);
      if (there) {
        EXPECT_TRUE(overlap(triangle, cells[i].cell, step))
            << "triangle " << t << " is in leaf " << i << " without reason";
      } else {
        EXPECT_FALSE(overlap(triangle, cells[i].cell, -rounding))
            << "triangle " << t << " is missing in leaf " << i;
      }
    }
  }
}

/// The leaf that has a point, or kLeaf's complement where the point is close to a plane on the way.
const Node* leaf_at(const Tree& tree, const Point& p, double slack) {
  const Node* node = tree.nodes().data();
  while (!node->is_leaf()) {
    const double split = node->split();
    if (std::abs(p[node->axis()] - split) <= slack) return nullptr;
    node = p[node->axis()] >= split ? tree.nodes().data() + node->upper() : node + 1;
  }
  return node;
}

/// Points of triangles are in leaves that have the triangle.
void check_points(const Soup& soup, Which which, int points_per_triangle) {
  const Result<Tree> result = build(soup, which);
  ASSERT_TRUE(result.ok());
  const Tree& tree = result.value();
  check_structure(tree, soup, which);
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::uint64_t checked = 0;
  for (std::uint32_t t = 0; t < soup.size(); ++t) {
    const auto corners = soup.view().triangle(t);
    for (int i = 0; i < points_per_triangle; ++i) {
      double u = unit(rng), v = unit(rng);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      Point p;
      for (std::size_t a = 0; a < 3; ++a) {
        p[a] = corners[0][a] + u * (double{corners[1][a]} - corners[0][a]) +
               v * (double{corners[2][a]} - corners[0][a]);
      }
      const Node* leaf = leaf_at(tree, p, 1e-12);
      if (leaf == nullptr) continue;
      const auto ids = tree.ids().subspan(leaf->first(), leaf->count());
      ASSERT_TRUE(std::binary_search(ids.begin(), ids.end(), t))
          << "triangle " << t << " is missing where a point of it lies";
      ++checked;
    }
  }
  EXPECT_GT(checked, std::uint64_t{soup.size()} * points_per_triangle * 9 / 10);
}

class Baseline : public ::testing::TestWithParam<Which> {};

INSTANTIATE_TEST_SUITE_P(Both, Baseline, ::testing::Values(Which::exact, Which::binned),
                         [](const auto& which) {
                           return which.param == Which::exact ? "exact" : "binned";
                         });

TEST_P(Baseline, LeavesHaveExactlyTheTrianglesThatReachThem) {
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    const float size = seed % 3 == 0 ? 0.7f : 0.1f;
    Soup soup = testing::random_soup(5 + 3 * seed, size, seed);
    check_leaves_exactly(soup, GetParam());
    check_leaves_exactly(testing::lattice_soup(5 + seed, 5, seed), GetParam());
    // A few binary32 steps across: leaves are as thin as the rounding.
    for (Vec3& p : soup.positions) p = p + Vec3{1e6f, -1e6f, 1e6f};
    check_leaves_exactly(soup, GetParam());
  }
}

TEST_P(Baseline, PointsOfATriangleAreInLeavesThatHaveIt) {
  check_points(testing::random_soup(20'000, 0.02f, 3), GetParam(), 8);
  check_points(testing::random_soup(300, 0.8f, 4), GetParam(), 100);
  check_points(testing::bumpy_ball(80), GetParam(), 20);
}

TEST_P(Baseline, SameBytesEveryTime) {
  const Soup soup = testing::random_soup(3'000, 0.05f, 5);
  const Result<Tree> first = build(soup, GetParam());
  const Result<Tree> second = build(soup, GetParam());
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first.value().hash(), second.value().hash());
}

TEST_P(Baseline, SameBytesThroughIndices) {
  // The same triangles through an index buffer, vertices with a stride and in reverse.
  const Soup soup = testing::random_soup(500, 0.1f, 6);
  struct Vertex {
    float colour;
    Vec3 position;
  };
  std::vector<Vertex> vertices;
  for (auto p = soup.positions.rbegin(); p != soup.positions.rend(); ++p)
    vertices.push_back({1, *p});
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    indices.push_back(static_cast<std::uint32_t>(vertices.size()) - 1 - i);
  }
  MeshView mesh;
  mesh.positions = &vertices[0].position;
  mesh.position_stride_bytes = sizeof(Vertex);
  mesh.vertex_count = static_cast<std::uint32_t>(vertices.size());
  mesh.indices = indices.data();
  mesh.triangle_count = soup.size();
  const ProgressCallback none;
  const BaselineInput input{mesh, soup.bounds(), {}, 0, none};
  const Result<Tree> indexed =
      GetParam() == Which::exact ? build_sah_exact(input) : build_sah_binned(input);
  const Result<Tree> plain = build(soup, GetParam());
  ASSERT_TRUE(indexed.ok() && plain.ok());
  EXPECT_EQ(indexed.value().hash(), plain.value().hash());
}

TEST(Baselines, ExactCostsNoMoreThanBinned) {
  const std::vector<Soup> soups{testing::random_soup(3'000, 0.02f, 1),
                                testing::random_soup(1'000, 0.5f, 2),
                                testing::random_soup(2'000, 0.1f, 3), testing::bumpy_ball(60)};
  for (std::size_t i = 0; i < soups.size(); ++i) {
    SCOPED_TRACE(i);
    const Result<Tree> exact = build(soups[i], Which::exact);
    const Result<Tree> binned = build(soups[i], Which::binned);
    ASSERT_TRUE(exact.ok() && binned.ok());
    const double exact_cost = measure_quality(exact.value()).sah_cost;
    const double binned_cost = measure_quality(binned.value()).sah_cost;
    // Both are greedy, so nothing is certain; the exact one has been 1 to 20 per cent cheaper.
    EXPECT_LE(exact_cost, 1.01 * binned_cost);
    // And neither is far from the other, or from one leaf with everything.
    EXPECT_LE(binned_cost, 1.6 * exact_cost);
    EXPECT_LT(binned_cost, 0.5 * leaf_cost(soups[i].size(), {}));
  }
}

TEST_P(Baseline, MemoryLimitIsKept) {
  const Soup soup = testing::random_soup(5'000, 0.05f, 8);
  const Result<Tree> free = build(soup, GetParam());
  ASSERT_TRUE(free.ok());
  for (const std::uint64_t limit : {1ull, 1'000ull, 30'000ull, 300'000ull, 1'000'000ull}) {
    const Result<Tree> result = build(soup, GetParam(), {}, limit);
    ASSERT_FALSE(result.ok()) << limit;
    EXPECT_EQ(result.status().code(), StatusCode::resource_limit);
    EXPECT_NE(result.status().message().find(std::to_string(limit) + " bytes"), std::string::npos)
        << result.status().message();
  }
  const Result<Tree> enough = build(soup, GetParam(), {}, 64'000'000);
  ASSERT_TRUE(enough.ok());
  EXPECT_EQ(enough.value().hash(), free.value().hash());
}

TEST_P(Baseline, ProgressRisesFromZeroToOne) {
  const Soup soup = testing::random_soup(20'000, 0.02f, 9);
  std::vector<double> fractions;
  const std::string stage = GetParam() == Which::exact ? "sah_exact" : "sah_binned";
  const Result<Tree> result =
      build(soup, GetParam(), {}, 0, [&](const char* name, double fraction) {
        EXPECT_EQ(name, stage);
        fractions.push_back(fraction);
        return true;
      });
  ASSERT_TRUE(result.ok());
  ASSERT_GE(fractions.size(), 4u);
  EXPECT_EQ(fractions.front(), 0.0);
  EXPECT_EQ(fractions.back(), 1.0);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
}

TEST_P(Baseline, CanBeCancelledAtEveryCall) {
  const Soup soup = testing::random_soup(10'000, 0.02f, 10);
  int calls = 0;
  ASSERT_TRUE(
      build(soup, GetParam(), {}, 0, [&](const char*, double) { return ++calls > 0; }).ok());
  for (int stop = 1; stop <= calls; stop += std::max(1, calls / 7)) {
    int call = 0;
    const Result<Tree> result =
        build(soup, GetParam(), {}, 0, [&](const char*, double) { return ++call < stop; });
    ASSERT_FALSE(result.ok()) << stop;
    EXPECT_EQ(result.status().code(), StatusCode::cancelled);
    EXPECT_EQ(call, stop);
  }
}

TEST_P(Baseline, CostsAreChecked) {
  const Soup soup = testing::random_soup(10, 0.1f, 11);
  const double inf = std::numeric_limits<double>::infinity();
  for (const SahCosts& costs : {SahCosts{-1, 20}, SahCosts{15, -1}, SahCosts{inf, 20},
                                SahCosts{15, std::numeric_limits<double>::quiet_NaN()}}) {
    const Result<Tree> result = build(soup, GetParam(), costs);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.status().code(), StatusCode::invalid_argument);
  }
  // Free tests: one leaf. Free steps: as deep as it may be, and no further.
  const Result<Tree> flat = build(soup, GetParam(), {15, 0});
  ASSERT_TRUE(flat.ok());
  EXPECT_EQ(flat.value().nodes().size(), 1u);
  const Result<Tree> deep = build(soup, GetParam(), {0, 20});
  ASSERT_TRUE(deep.ok());
  check_structure(deep.value(), soup, GetParam());
  EXPECT_GT(deep.value().nodes().size(), build(soup, GetParam()).value().nodes().size());
}

}  // namespace
}  // namespace fasttree::baseline
