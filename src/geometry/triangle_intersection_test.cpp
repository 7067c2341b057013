// SPDX-License-Identifier: Apache-2.0
#include "geometry/triangle_intersection.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/meshes.h"

namespace fasttree {
namespace {

struct Outcome {
  bool hit = false;
  float t = 0, u = 0, v = 0;
};

Outcome run(const Ray& ray, const std::array<Vec3, 3>& triangle) {
  Outcome o;
  const ShearedRay sheared = shear(ray);
  if (sheared.valid) {
    o.hit = intersect_triangle(sheared, ray.t_min, ray.t_max, triangle, o.t, o.u, o.v);
  }
  return o;
}

const std::array<Vec3, 3> kTriangle{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};

TEST(TriangleIntersection, FindsDistanceAndBarycentricsFromBothSides) {
  const Outcome front = run({{0.25f, 0.5f, 2}, 0, {0, 0, -1}}, kTriangle);
  ASSERT_TRUE(front.hit);
  EXPECT_EQ(front.t, 2.0f);
  EXPECT_EQ(front.u, 0.25f);
  EXPECT_EQ(front.v, 0.5f);
  const Outcome back = run({{0.25f, 0.5f, -2}, 0, {0, 0, 4}}, kTriangle);
  ASSERT_TRUE(back.hit);
  EXPECT_EQ(back.t, 0.5f) << "t counts in lengths of the direction";
  EXPECT_EQ(back.u, 0.25f);
}

TEST(TriangleIntersection, RespectsTheInterval) {
  Ray ray{{0.25f, 0.25f, 2}, 0, {0, 0, -1}};
  ray.t_min = 2;
  ray.t_max = 2;
  EXPECT_TRUE(run(ray, kTriangle).hit) << "both ends belong to the interval";
  ray.t_min = std::nextafter(2.0f, 3.0f);
  EXPECT_FALSE(run(ray, kTriangle).hit);
  ray.t_min = 0;
  ray.t_max = std::nextafter(2.0f, 1.0f);
  EXPECT_FALSE(run(ray, kTriangle).hit);
  ray.t_max = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(run(ray, kTriangle).hit);
}

TEST(TriangleIntersection, HitsEdgesAndCornersOnTheTriangle) {
  for (const Vec3 p : {Vec3{0, 0, 1}, Vec3{1, 0, 1}, Vec3{0, 1, 1}, Vec3{0.5f, 0, 1},
                       Vec3{0, 0.5f, 1}, Vec3{0.5f, 0.5f, 1}}) {
    EXPECT_TRUE(run({p, 0, {0, 0, -1}}, kTriangle).hit) << p.x << ' ' << p.y;
  }
  EXPECT_FALSE(run({{-1e-7f, 0.5f, 1}, 0, {0, 0, -1}}, kTriangle).hit);
}

TEST(TriangleIntersection, NeverHitsZeroArea) {
  test::Random random(7);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 a = random.point(-1, 1);
    const Vec3 b = random.point(-1, 1);
    const Vec3 origin = random.point(-2, 2);
    const Vec3 through = i % 2 == 0 ? a : b;
    const Ray ray{origin, 0, through - origin};
    EXPECT_FALSE(run(ray, {a, a, a}).hit);
    EXPECT_FALSE(run(ray, {a, b, a}).hit);
    EXPECT_FALSE(run(ray, {a, b, b}).hit);
  }
}

TEST(TriangleIntersection, InvalidRaysHitNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const Vec3 d :
       {Vec3{0, 0, 0}, Vec3{nan, 0, -1}, Vec3{0, 0, -inf}, Vec3{0, inf, -1}, Vec3{0, 0, -1e-40f}}) {
    EXPECT_FALSE(shear({{0.25f, 0.25f, 1}, 0, d}).valid);
  }
  for (const Vec3 o : {Vec3{nan, 0, 1}, Vec3{0.2f, inf, 1}}) {
    EXPECT_FALSE(shear({o, 0, {0, 0, -1}}).valid);
  }
}

// A closed fan round a vertex: a ray through the inside can slip through none of its edges.
TEST(TriangleIntersection, IsWatertightAlongSharedEdges) {
  test::Random random(11);
  for (int round = 0; round < 4000; ++round) {
    const Vec3 a = random.point(-1, 1), b = random.point(-1, 1), c = random.point(-1, 1),
               d = random.point(-1, 1);
    // The tetrahedron's faces: a ray from an inside point hits at least one face; one that enters
    // from outside through an edge or a vertex hits at least two.
    const std::array<std::array<Vec3, 3>, 4> faces{{{a, b, c}, {a, c, d}, {a, d, b}, {b, d, c}}};
    const float s = random.in(0, 1);
    const Vec3 on_edge = a * s + b * (1 - s);
    const Vec3 centre = (a + b + c + d) * 0.25f;
    for (const Vec3 target : {on_edge, a, b}) {
      const Ray ray{centre, 0, target - centre};
      int hits = 0;
      for (const auto& face : faces) hits += run(ray, face).hit ? 1 : 0;
      EXPECT_GE(hits, 1) << "a ray from the inside slipped through";
    }
  }
}

}  // namespace
}  // namespace fasttree
