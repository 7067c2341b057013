// SPDX-License-Identifier: Apache-2.0
#include "build/triangle_block.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/scene_bound.h"
#include "tests/support/meshes.h"

namespace fasttree::build {
namespace {

std::vector<test::OwnedMesh> meshes() {
  std::vector<test::OwnedMesh> list;
  for (const std::uint32_t n : {1u, 2u, 15u, 16u, 17u, 255u, 256u})
    list.push_back(test::soup(n, n, 0.3f));
  for (test::NamedMesh& named : test::degenerate_meshes()) {
    if (named.mesh.view().triangle_count > 0) list.push_back(std::move(named.mesh));
  }
  return list;
}

TEST(TriangleBlock, ScalarAndWidestAgreeWithTheDefinition) {
  for (const test::OwnedMesh& owned : meshes()) {
    const MeshView mesh = owned.view();
    const std::uint32_t count = std::min(kBlock, mesh.triangle_count);
    TriangleBlock block;
    gather(mesh, 0, count, block);
    const Box3 scene = reference::scene_bound(mesh).value();
    MeshView part = mesh;
    part.triangle_count = count;
    const Box3 expected = reference::scene_bound(part).value();
    const AxisLevels levels = make_axis_levels(scene, AxisSchedule::longest);
    const std::array<AxisQuantiser, 3> quantisers{make_axis_quantiser(scene, levels, 0),
                                                  make_axis_quantiser(scene, levels, 1),
                                                  make_axis_quantiser(scene, levels, 2)};
    for (const Simd simd : {Simd::scalar, Simd::widest}) {
      Box3 bounds;
      EXPECT_TRUE(scene_bound(simd, block, bounds));
      EXPECT_EQ(bounds, expected);

      BoxBlock boxes;
      quantise(simd, block, quantisers, boxes);
      ReferenceCounts expected_counts;
      for (std::uint32_t i = 0; i < count; ++i) {
        const CellBox box = finest_cells_of(quantisers, mesh.triangle(i));
        for (std::size_t a = 0; a < 3; ++a) {
          ASSERT_EQ(boxes.lo[a][i], box.lo[a]);
          ASSERT_EQ(boxes.hi[a][i], box.hi[a]);
        }
        expected_counts.add(levels, box);
      }
      ReferenceCounts counts;
      count_references(simd, boxes, levels, levels.levels, counts);
      EXPECT_EQ(counts.at, expected_counts.at);
    }
  }
}

TEST(TriangleBlock, NoticesWhatIsNotFiniteInEveryLane) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    for (std::uint32_t i = 0; i < 37; ++i) {
      test::OwnedMesh owned = test::soup(37, 1, 0.1f);
      owned.positions[3 * i + i % 3][i % 2 + 1] = bad;
      TriangleBlock block;
      gather(owned.view(), 0, 37, block);
      for (const Simd simd : {Simd::scalar, Simd::widest}) {
        Box3 bounds;
        EXPECT_FALSE(scene_bound(simd, block, bounds)) << i;
      }
    }
  }
}

TEST(TriangleBlock, NamesTheInstructionSet) {
  EXPECT_STRNE(widest_simd_name(), "");
}

}  // namespace
}  // namespace fasttree::build
