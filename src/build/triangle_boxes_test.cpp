// SPDX-License-Identifier: Apache-2.0
#include "build/triangle_boxes.h"

#include <gtest/gtest.h>

#include "reference/scene_bound.h"
#include "tests/support/meshes.h"

namespace fasttree::build {
namespace {

TEST(TriangleBoxes, EqualTheGridsCellsAndCounts) {
  for (const test::OwnedMesh& owned :
       {test::soup(1, 1, 1), test::soup(255, 2, 0.2f), test::soup(256, 3, 0.2f),
        test::soup(5000, 4, 0.05f), test::sheet(40, 0.2f)}) {
    const MeshView mesh = owned.view();
    const Box3 bounds = reference::scene_bound(mesh).value();
    for (const AxisSchedule schedule : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      const AxisLevels levels = make_axis_levels(bounds, schedule);
      const ReferenceCounts expected = fasttree::count_references(mesh, bounds, schedule);
      for (const int depth : {0, 7, 21, levels.levels}) {
        const VertexEncoder encoder(bounds, levels, depth);
        const Grid grid(bounds, schedule, depth);
        for (const Simd simd : {Simd::scalar, Simd::widest}) {
          Buffer<std::uint32_t> codes;
          Buffer<CodeBox> boxes;
          encode_vertices(mesh, encoder, simd, codes);
          const BoxPass pass = box_triangles(mesh, bounds, codes, encoder.axes, simd, boxes);
          ASSERT_TRUE(pass.indices_ok);
          EXPECT_EQ(pass.touches, kTouchesAll);
          EXPECT_EQ(pass.references, expected.at[static_cast<std::size_t>(depth)]);
          const ReferenceCounts counts = count_references(boxes, levels, depth);
          for (std::size_t d = 0; d <= static_cast<std::size_t>(depth); ++d) {
            EXPECT_EQ(counts.at[d], expected.at[d]);
          }
          for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
            const CellBox box = grid.cells_of(mesh.triangle(t));
            ASSERT_EQ(boxes[t], (CodeBox{grid.morton_code(box.lo), grid.morton_code(box.hi)}));
          }
        }
      }
    }
  }
}

TEST(TriangleBoxes, NoticeABadIndexAndVerticesNobodyUses) {
  test::OwnedMesh owned = test::sheet(20, 0.2f);
  const Box3 bounds = reference::scene_bound(owned.view()).value();
  const CodeAxes axes(make_axis_levels(bounds, AxisSchedule::cyclic), 5);
  std::vector<std::uint32_t> codes(owned.positions.size());
  Buffer<CodeBox> boxes;
  for (const Simd simd : {Simd::scalar, Simd::widest}) {
    // Nothing is marked, so no side is touched.
    EXPECT_EQ(box_triangles(owned.view(), bounds, codes, axes, simd, boxes).touches, 0u);
  }
  owned.indices[701] = static_cast<std::uint32_t>(owned.positions.size());
  for (const Simd simd : {Simd::scalar, Simd::widest}) {
    EXPECT_FALSE(box_triangles(owned.view(), bounds, codes, axes, simd, boxes).indices_ok);
  }
}

}  // namespace
}  // namespace fasttree::build
