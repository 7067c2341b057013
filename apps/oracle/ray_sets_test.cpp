// SPDX-License-Identifier: Apache-2.0
#include "oracle/ray_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fasttree::oracle {
namespace {

// Two triangles over a unit square, and a tree that halves the square in x.
struct Square {
  std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.25f}, {0, 1, 0.5f}};
  std::vector<std::uint32_t> indices = {0, 1, 2, 0, 2, 3};
  MeshView mesh{positions.data(), sizeof(Vec3), 4, indices.data(), 2};
  Tree tree{
      TreeInfo{Profile::paper, AxisSchedule::cyclic, 1, {1, 0, 0}, 2, {{0, 0, 0}, {1, 1, 0.5f}}},
      {Node::inner(0, 0.5f, 2), Node::leaf(0, 2), Node::leaf(2, 2)},
      {0, 1, 0, 1}};
};

std::vector<Ray> rays_of(const RayGenerator& generator, RaySet set, std::size_t n) {
  std::vector<Ray> rays(n);
  generator.generate(set, 0, rays);
  return rays;
}

bool same_ray(const Ray& a, const Ray& b) {
  return a.origin == b.origin && a.direction == b.direction && a.t_min == b.t_min &&
         a.t_max == b.t_max;
}

TEST(RaySets, ARayDependsOnItsNumberOnly) {
  const Square square;
  const RayGenerator generator(square.mesh, square.tree, 7);
  for (const RaySet set : kAllRaySets) {
    const auto all = rays_of(generator, set, 100);
    std::vector<Ray> part(40);
    generator.generate(set, 60, part);
    for (std::size_t i = 0; i < part.size(); ++i) {
      EXPECT_TRUE(same_ray(all[60 + i], part[i])) << to_string(set) << ' ' << i;
    }
  }
}

TEST(RaySets, SeedsAndSetsDiffer) {
  const Square square;
  const RayGenerator a(square.mesh, square.tree, 1);
  const RayGenerator b(square.mesh, square.tree, 2);
  for (const RaySet set : kAllRaySets) {
    const auto x = rays_of(a, set, 50);
    const auto y = rays_of(b, set, 50);
    EXPECT_FALSE(std::equal(x.begin(), x.end(), y.begin(), same_ray)) << to_string(set);
  }
}

TEST(RaySets, RaysAreFinite) {
  const Square square;
  const RayGenerator generator(square.mesh, square.tree, 3);
  for (const RaySet set : kAllRaySets) {
    for (const Ray& ray : rays_of(generator, set, 1000)) {
      for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_TRUE(std::isfinite(ray.origin[a]) && std::isfinite(ray.direction[a]))
            << to_string(set);
      }
      EXPECT_LE(ray.t_min, ray.t_max) << to_string(set);
    }
  }
}

TEST(RaySets, PlaneRaysLieInASplitPlane) {
  const Square square;
  const RayGenerator generator(square.mesh, square.tree, 4);
  std::size_t in_middle = 0;
  for (const Ray& ray : rays_of(generator, RaySet::planes, 1000)) {
    bool lies = false;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool flat = ray.direction[a] == 0.0f;
      const float x = ray.origin[a];
      const Box3& b = square.tree.info().bounds;
      if (flat && a == 0 && x == 0.5f) ++in_middle;
      lies = lies || (flat && (x == b.lo[a] || x == b.hi[a] || (a == 0 && x == 0.5f)));
    }
    EXPECT_TRUE(lies);
  }
  EXPECT_GT(in_middle, 50u);
}

TEST(RaySets, VertexRaysPassThroughVertices) {
  const Square square;
  const RayGenerator generator(square.mesh, square.tree, 5);
  std::size_t exact_ends = 0;
  for (const Ray& ray : rays_of(generator, RaySet::vertices, 500)) {
    float least = 1e9f;
    for (const Vec3 v : square.positions) {
      const Vec3 d = ray.origin + ray.direction - v;
      least = std::min(least, std::sqrt(dot(d, d)));
    }
    EXPECT_LT(least, 1e-5f);
    exact_ends += ray.t_max == 1.0f ? 1 : 0;
  }
  EXPECT_GT(exact_ends, 100u);
}

TEST(RaySets, EmptyMeshAndSinglePointGiveFiniteRays) {
  const Tree empty;
  const MeshView nothing;
  const RayGenerator generator(nothing, empty, 6);
  for (const RaySet set : kAllRaySets) {
    for (const Ray& ray : rays_of(generator, set, 100)) {
      EXPECT_TRUE(std::isfinite(dot(ray.origin, ray.origin))) << to_string(set);
      EXPECT_TRUE(std::isfinite(dot(ray.direction, ray.direction))) << to_string(set);
    }
  }
}

}  // namespace
}  // namespace fasttree::oracle
