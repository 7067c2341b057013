// SPDX-License-Identifier: Apache-2.0
#include "render/surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/sampling.h"

namespace fasttree::render {
namespace {

MeshView view_of(const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& indices) {
  MeshView mesh;
  mesh.positions = positions.data();
  mesh.vertex_count = static_cast<std::uint32_t>(positions.size());
  mesh.indices = indices.empty() ? nullptr : indices.data();
  mesh.triangle_count =
      static_cast<std::uint32_t>((indices.empty() ? positions.size() : indices.size()) / 3);
  return mesh;
}

// Two triangles in a roof over the x axis: one nearly flat and large, one steep and small.
const std::vector<Vec3> kRoof{{0, 0, 0}, {1, 0, 0}, {0, 2, 0.2f}, {0, -1, 0.1f}};
const std::vector<std::uint32_t> kRoofIndices{0, 1, 2, 1, 0, 3};

TEST(VertexNormals, WeightedByArea) {
  const auto normals = vertex_normals(view_of(kRoof, kRoofIndices));
  ASSERT_EQ(normals.size(), 4u);
  // Twice the areas: (0, -0.2, 2) and (0, 0.1, 1).
  const Double3 expected = normalized({0, -0.1, 3});
  EXPECT_NEAR(normals[0].y, expected.y, 1e-6);
  EXPECT_NEAR(normals[0].z, expected.z, 1e-6);
  EXPECT_EQ(normals[0], normals[1]);
  EXPECT_NEAR(normals[2].y, normalized({0, -0.2, 2}).y, 1e-6);
}

TEST(VertexNormals, AnySizeOfMesh) {
  for (const float scale : {1e-25f, 1e-10f, 1e10f, 1e18f}) {
    std::vector<Vec3> positions = kRoof;
    for (Vec3& p : positions) p = p * scale;
    const auto normals = vertex_normals(view_of(positions, kRoofIndices));
    ASSERT_EQ(normals.size(), 4u);
    for (const Vec3& n : normals) EXPECT_NEAR(length(Double3(n)), 1, 1e-6) << scale;
  }
}

TEST(VertexNormals, NoneForLooseOrFlatMeshes) {
  EXPECT_TRUE(vertex_normals(view_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {})).empty());
  const std::vector<Vec3> point(3, Vec3{1, 2, 3});
  EXPECT_TRUE(vertex_normals(view_of(point, {0, 1, 2})).empty());
  const std::vector<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const auto normals = vertex_normals(view_of(line, {0, 1, 2}));
  for (const Vec3& n : normals) EXPECT_EQ(n, Vec3{});
}

TEST(SurfacePoint, FacesTheViewerFromBothSides) {
  const MeshView mesh = view_of(kRoof, kRoofIndices);
  const auto normals = vertex_normals(mesh);
  Hit hit;
  hit.triangle = 0;
  hit.u = 0.25f;
  hit.v = 0.5f;
  for (const double z : {-1.0, 1.0}) {
    for (const bool smooth : {false, true}) {
      const Double3 along = normalized({0.1, 0.2, z});
      const SurfacePoint s =
          surface_point(mesh, smooth ? normals : std::vector<Vec3>{}, hit, along);
      EXPECT_LT(dot(s.geometric, along), 0);
      EXPECT_LE(dot(s.shading, along), 0);
      EXPECT_NEAR(length(s.geometric), 1, 1e-12);
      EXPECT_NEAR(length(s.shading), 1, 1e-12);
      EXPECT_NEAR(s.position.x, 0.25, 1e-6);
      EXPECT_NEAR(s.position.y, 1.0, 1e-6);
      EXPECT_GT(s.epsilon, 0);
      if (!smooth) {
        EXPECT_NEAR(dot(s.shading, s.geometric), 1, 1e-12);
      }
    }
  }
}

TEST(SurfacePoint, SharpEdgesStaySharp) {
  // A right angle: the mean normal is 45 degrees away, smooth; a needle's edge is not.
  const std::vector<Vec3> needle{{0, 0, 0}, {1, 0, 0}, {0, 2, 5}, {0, -2, 5}};
  const MeshView mesh = view_of(needle, kRoofIndices);
  const auto normals = vertex_normals(mesh);
  Hit hit;
  hit.triangle = 0;
  hit.u = hit.v = 0.1f;
  const SurfacePoint s = surface_point(mesh, normals, hit, {0, 1, 0});
  EXPECT_NEAR(dot(s.shading, s.geometric), 1, 1e-6);
}

TEST(Sampling, ReproducibleAndEven) {
  double sum_u = 0, sum_v = 0;
  constexpr std::uint32_t kCount = 4096;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Sample2 s = sample(3, 9, Purpose::pixel, i);
    ASSERT_GE(s.u, 0.0);
    ASSERT_LT(s.u, 1.0);
    ASSERT_GE(s.v, 0.0);
    ASSERT_LT(s.v, 1.0);
    sum_u += s.u;
    sum_v += s.v;
    const Double3 d = cosine_hemisphere(s);
    ASSERT_NEAR(length(d), 1, 1e-12);
    ASSERT_GE(d.z, 0);
  }
  EXPECT_NEAR(sum_u / kCount, 0.5, 0.01);
  EXPECT_NEAR(sum_v / kCount, 0.5, 0.01);
  EXPECT_NE(sample(3, 9, Purpose::pixel, 0).u, sample(4, 9, Purpose::pixel, 0).u);
  EXPECT_NE(sample(3, 9, Purpose::pixel, 0).u, sample(3, 9, Purpose::light, 0).u);
}

TEST(Basis, Orthonormal) {
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Basis basis(spiral_direction(i, 100));
    EXPECT_NEAR(length(basis.tangent), 1, 1e-12);
    EXPECT_NEAR(length(basis.bitangent), 1, 1e-12);
    EXPECT_NEAR(dot(basis.tangent, basis.normal), 0, 1e-12);
    EXPECT_NEAR(dot(basis.tangent, basis.bitangent), 0, 1e-12);
  }
}

}  // namespace
}  // namespace fasttree::render
