// SPDX-License-Identifier: Apache-2.0
#include "baseline/triangle_clip.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace fasttree::baseline {
namespace {

using Triangle = std::array<Vec3, 3>;

double area(const ClippedPolygon& polygon) {
  std::array<double, 3> sum{};
  for (std::size_t i = 2; i < polygon.size; ++i) {
    std::array<double, 3> u{}, v{};
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = polygon.points[i - 1][k] - polygon.points[0][k];
      v[k] = polygon.points[i][k] - polygon.points[0][k];
    }
    sum[0] += u[1] * v[2] - u[2] * v[1];
    sum[1] += u[2] * v[0] - u[0] * v[2];
    sum[2] += u[0] * v[1] - u[1] * v[0];
  }
  return std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / 2;
}

Vec3 random_point(std::mt19937& rng, float lo, float hi) {
  std::uniform_real_distribution<float> d(lo, hi);
  return {d(rng), d(rng), d(rng)};
}

Box3 random_box(std::mt19937& rng) {
  Box3 box;
  box.include(random_point(rng, 0, 1));
  box.include(random_point(rng, 0, 1));
  return box;
}

TEST(TriangleClip, LeavesATriangleInsideTheBoxAlone) {
  const Triangle triangle{Vec3{0.1f, 0.2f, 0.3f}, Vec3{0.9f, 0.2f, 0.5f}, Vec3{0.1f, 1.0f, 0.0f}};
  const ClippedPolygon polygon = clip_to_box(triangle, {{0, 0, 0}, {1, 1, 1}});
  ASSERT_EQ(polygon.size, 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(polygon.points[i][a], triangle[i][a]);
  }
  const Box3 expected{{0.1f, 0.2f, 0.0f}, {0.9f, 1.0f, 0.5f}};
  EXPECT_EQ(outward_bounds(polygon, {{0, 0, 0}, {1, 1, 1}}), expected);
}

TEST(TriangleClip, MakesAHexagonOfACubesDiagonalSection) {
  // x + y + z = 1.5 through the unit cube: the regular hexagon with side sqrt(1/2).
  const Triangle triangle{Vec3{4.5f, -1.5f, -1.5f}, Vec3{-1.5f, 4.5f, -1.5f},
                          Vec3{-1.5f, -1.5f, 4.5f}};
  const ClippedPolygon polygon = clip_to_box(triangle, {{0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(polygon.size, 6u);
  EXPECT_NEAR(area(polygon), 0.5 * 3 * std::sqrt(3.0) / 2, 1e-14);
}

TEST(TriangleClip, KeepsATriangleThatTouches) {
  const Box3 box{{0, 0, 0}, {1, 1, 1}};
  const Triangle corner{Vec3{1, 1, 1}, Vec3{2, 1, 1}, Vec3{1, 2, 1}};
  EXPECT_GT(clip_to_box(corner, box).size, 0u);
  const Triangle face{Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{1, 0, 1}};
  EXPECT_NEAR(area(clip_to_box(face, box)), 0.5, 0.0);
  const Triangle away{Vec3{1.5f, 0, 0}, Vec3{1.5f, 1, 0}, Vec3{1.5f, 0, 1}};
  EXPECT_EQ(clip_to_box(away, box).size, 0u);
}

TEST(TriangleClip, RoundsBoundsOutward) {
  // The edge from (0, 0, 0) to (1, 1/3, 0) is at y = 1/9 where x = 1/3; neither is a binary32.
  const float third = 1.0f / 3.0f;
  const Triangle triangle{Vec3{0, 0, 0}, Vec3{1, third, 0}, Vec3{1, 0, 0}};
  const Box3 half{{0, 0, 0}, {third, 1, 1}};
  const Box3 bounds = outward_bounds(clip_to_box(triangle, half), half);
  const double y = double{third} * third;
  EXPECT_EQ(bounds.hi.x, third);
  EXPECT_GE(double{bounds.hi.y}, y);
  EXPECT_LT(double{std::nextafterf(bounds.hi.y, 0.0f)}, y);
}

TEST(TriangleClip, PartsAddUpToTheWhole) {
  const bool ok = rc::check("area below + area above = area", [](std::uint32_t seed) {
    std::mt19937 rng(seed);
    const Triangle triangle{random_point(rng, -1, 2), random_point(rng, -1, 2),
                            random_point(rng, -1, 2)};
    const ClippedPolygon polygon = clip_to_box(triangle, random_box(rng));
    ClippedPolygon lower, upper;
    const std::size_t axis = rng() % 3;
    const float split = random_point(rng, 0, 1).x;
    cut(polygon, axis, split, lower, upper);
    RC_ASSERT(std::abs(area(lower) + area(upper) - area(polygon)) < 1e-12);
  });
  ASSERT_TRUE(ok);
}

TEST(TriangleClip, BoundsHoldEveryPointOfThePart) {
  // Judge: points of the triangle by their barycentric coordinates, kept where they lie in the box.
  const bool ok = rc::check("sampled points lie in the bounds", [](std::uint32_t seed) {
    std::mt19937 rng(seed);
    const Triangle triangle{random_point(rng, -1, 2), random_point(rng, -1, 2),
                            random_point(rng, -1, 2)};
    const Box3 box = random_box(rng);
    const ClippedPolygon polygon = clip_to_box(triangle, box);
    Box3 bounds;
    if (polygon.size > 0) {
      bounds = outward_bounds(polygon, box);
      for (std::size_t a = 0; a < 3; ++a) {
        RC_ASSERT(bounds.lo[a] >= box.lo[a]);
        RC_ASSERT(bounds.hi[a] <= box.hi[a]);
      }
    }
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 200; ++i) {
      double u = unit(rng), v = unit(rng);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      bool inside_box = true, inside_bounds = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const double p = triangle[0][a] + u * (double{triangle[1][a]} - triangle[0][a]) +
                         v * (double{triangle[2][a]} - triangle[0][a]);
        inside_box = inside_box && box.lo[a] + 1e-12 < p && p < box.hi[a] - 1e-12;
        inside_bounds = inside_bounds && bounds.lo[a] <= p && p <= bounds.hi[a];
      }
      if (inside_box) RC_ASSERT(inside_bounds);
    }
  });
  ASSERT_TRUE(ok);
}

TEST(TriangleClip, CutBoundsKeepEveryTriangleOnASide) {
  const Box3 cell{{0, 0, 0}, {1, 1, 1}};
  const Triangle crossing{Vec3{0.2f, 0.2f, 0.2f}, Vec3{0.8f, 0.4f, 0.2f}, Vec3{0.2f, 0.6f, 0.2f}};
  CutBounds parts = cut_bounds(crossing, cell, 0, 0.5f);
  ASSERT_TRUE(parts.in_lower && parts.in_upper);
  EXPECT_EQ(parts.lower.hi.x, 0.5f);
  EXPECT_EQ(parts.upper.lo.x, 0.5f);
  EXPECT_NEAR(parts.upper.lo.y, 0.3f, 1e-6f);
  EXPECT_NEAR(parts.upper.hi.y, 0.5f, 1e-6f);

  const Triangle touching{Vec3{0.5f, 0.2f, 0.2f}, Vec3{0.2f, 0.4f, 0.2f}, Vec3{0.5f, 0.6f, 0.2f}};
  parts = cut_bounds(touching, cell, 0, 0.5f);
  EXPECT_TRUE(parts.in_lower && !parts.in_upper);

  const Triangle planar{Vec3{0.5f, 0.2f, 0.2f}, Vec3{0.5f, 0.4f, 0.2f}, Vec3{0.5f, 0.6f, 0.4f}};
  parts = cut_bounds(planar, cell, 0, 0.5f);
  EXPECT_TRUE(!parts.in_lower && parts.in_upper);

  // Zero area: a point. It is kept all the same.
  const Triangle point{Vec3{0.2f, 0.2f, 0.2f}, Vec3{0.2f, 0.2f, 0.2f}, Vec3{0.2f, 0.2f, 0.2f}};
  parts = cut_bounds(point, cell, 0, 0.5f);
  EXPECT_TRUE(parts.in_lower && !parts.in_upper);

  // A triangle outside the cell cannot be asked for, unless rounding lost it: both sides keep it.
  const Triangle outside{Vec3{2, 2, 2}, Vec3{3, 2, 2}, Vec3{2, 3, 2}};
  parts = cut_bounds(outside, cell, 0, 0.5f);
  EXPECT_TRUE(parts.in_lower && parts.in_upper);
  EXPECT_FALSE(parts.lower.empty());
  EXPECT_FALSE(parts.upper.empty());
}

TEST(TriangleClip, HugeCoordinatesStayFinite) {
  const float huge = std::numeric_limits<float>::max();
  const Box3 cell{{-huge, -huge, -huge}, {huge, huge, huge}};
  const Triangle triangle{Vec3{-huge, -huge, huge}, Vec3{huge, -huge, -huge},
                          Vec3{huge, huge, huge}};
  const CutBounds parts = cut_bounds(triangle, cell, 1, 1.0f);
  ASSERT_TRUE(parts.in_lower && parts.in_upper);
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_TRUE(std::isfinite(parts.lower.lo[a]) && std::isfinite(parts.lower.hi[a]));
    EXPECT_TRUE(std::isfinite(parts.upper.lo[a]) && std::isfinite(parts.upper.hi[a]));
  }
}

}  // namespace
}  // namespace fasttree::baseline
