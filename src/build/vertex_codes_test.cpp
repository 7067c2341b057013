// SPDX-License-Identifier: Apache-2.0
#include "build/vertex_codes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "reference/scene_bound.h"
#include "tests/support/meshes.h"

namespace fasttree::build {
namespace {

std::vector<test::OwnedMesh> meshes() {
  std::vector<test::OwnedMesh> list;
  for (const std::uint32_t n : {1u, 2u, 5u, 6u, 11u, 3000u}) list.push_back(test::soup(n, n, 0.3f));
  for (test::NamedMesh& named : test::degenerate_meshes()) {
    if (named.mesh.view().triangle_count > 0) list.push_back(std::move(named.mesh));
  }
  return list;
}

TEST(VertexCodes, ScalarAndWidestAgreeWithTheDefinition) {
  for (const test::OwnedMesh& owned : meshes()) {
    const MeshView mesh = owned.view();
    const Box3 expected = reference::scene_bound(mesh).value();
    const AxisLevels levels = make_axis_levels(expected, AxisSchedule::longest);
    const int depth = std::min(levels.levels, 26);
    const Grid grid(expected, AxisSchedule::longest, depth);
    for (const Simd simd : {Simd::scalar, Simd::widest}) {
      Box3 bounds;
      ASSERT_TRUE(vertex_bounds(mesh, {}, simd, bounds));
      EXPECT_EQ(bounds, expected);
      for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_FALSE(bounds.lo[a] == 0 && std::signbit(bounds.lo[a]));
        EXPECT_FALSE(bounds.hi[a] == 0 && std::signbit(bounds.hi[a]));
      }
      Buffer<std::uint32_t> codes;
      encode_vertices(mesh, VertexEncoder(bounds, levels, depth), simd, codes);
      ASSERT_EQ(codes.size(), mesh.vertex_count);
      for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
        const Vec3 p = mesh.position(v);
        std::uint32_t code = 0;
        for (std::size_t a = 0; a < 3; ++a) {
          Cell cell{};
          cell[a] = grid.quantise(a, p[a]);
          code |= grid.morton_code(cell);
          const bool touches = p[a] == bounds.lo[a] || p[a] == bounds.hi[a];
          if (touches && bounds.lo[a] < bounds.hi[a]) code |= kTouchesBounds;
        }
        ASSERT_EQ(codes[v], code);
      }
    }
  }
}

TEST(VertexCodes, ReadAnyStrideAndAlignment) {
  const test::OwnedMesh owned = test::soup(700, 3, 0.2f);
  const MeshView mesh = owned.view();
  const Box3 bounds = reference::scene_bound(mesh).value();
  const AxisLevels levels = make_axis_levels(bounds, AxisSchedule::cyclic);
  const VertexEncoder encoder(bounds, levels, 22);
  Buffer<std::uint32_t> expected, codes;
  encode_vertices(mesh, encoder, Simd::scalar, expected);
  for (const std::size_t stride : {12u, 13u, 16u, 32u}) {
    for (const std::size_t offset : {0u, 1u, 4u}) {
      std::vector<unsigned char> bytes(offset + stride * mesh.vertex_count);
      for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
        const Vec3 p = mesh.position(v);
        std::memcpy(&bytes[offset + stride * v], &p, sizeof p);
      }
      MeshView strided = mesh;
      strided.positions = bytes.data() + offset;
      strided.position_stride_bytes = stride;
      Box3 box;
      ASSERT_TRUE(vertex_bounds(strided, {}, Simd::widest, box));
      EXPECT_EQ(box, bounds);
      encode_vertices(strided, encoder, Simd::widest, codes);
      EXPECT_EQ(codes, expected);
    }
  }
}

TEST(VertexCodes, NoticeWhatIsNotFiniteInEveryPlace) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    for (std::uint32_t v = 0; v < 75; ++v) {
      test::OwnedMesh owned = test::soup(25, 1, 0.1f);
      owned.positions[v][v % 3] = bad;
      for (const Simd simd : {Simd::scalar, Simd::widest}) {
        Box3 bounds;
        EXPECT_FALSE(vertex_bounds(owned.view(), {}, simd, bounds)) << v;
      }
    }
  }
}

TEST(VertexCodes, SkipVerticesAndMarkThoseOutside) {
  test::OwnedMesh owned = test::soup(2000, 1, 0.1f);
  const std::vector<std::uint32_t> skipped{0, 1, 77, 3000, 5999, 7000};  // the last is none
  const Box3 bounds = reference::scene_bound(owned.view()).value();
  std::vector<Vec3> kept = owned.positions;
  for (const std::uint32_t v : skipped) {
    if (v < kept.size()) kept[v] = kept[2];
    if (v < kept.size()) owned.positions[v] = {9, v % 2 == 0 ? NAN : -9.0f, INFINITY};
  }
  Box3 expected;
  for (const Vec3& p : kept) expected.include(p);
  const VertexEncoder encoder(expected, make_axis_levels(bounds, AxisSchedule::cyclic), 20);
  for (const Simd simd : {Simd::scalar, Simd::widest}) {
    Box3 found;
    ASSERT_TRUE(vertex_bounds(owned.view(), skipped, simd, found));
    EXPECT_EQ(found, expected);
    Buffer<std::uint32_t> codes;
    encode_vertices(owned.view(), encoder, simd, codes);
    for (std::uint32_t v = 0; v < codes.size(); ++v) {
      const bool outside = std::find(skipped.begin(), skipped.end(), v) != skipped.end();
      ASSERT_EQ((codes[v] & kOutside) != 0, outside) << v;
    }
  }
}

TEST(VertexCodes, NameTheInstructionSet) {
  EXPECT_STRNE(widest_simd_name(), "");
}

}  // namespace
}  // namespace fasttree::build
