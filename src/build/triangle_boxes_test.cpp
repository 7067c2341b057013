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
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      const AxisLevels schedule = make_axis_levels(bounds, axes);
      const std::array<AxisQuantiser, 3> quantisers{make_axis_quantiser(bounds, schedule, 0),
                                                    make_axis_quantiser(bounds, schedule, 1),
                                                    make_axis_quantiser(bounds, schedule, 2)};
      std::vector<VertexCell> cells;
      quantise_vertices(mesh, bounds, quantisers, Simd::scalar, cells);
      const ReferenceCounts expected = fasttree::count_references(mesh, bounds, axes);
      std::vector<TriangleBox> boxes;
      for (const int depth : {0, 7, 21, schedule.levels}) {
        const BoxPass pass = box_triangles(mesh, cells, schedule, {depth, depth / 2}, boxes);
        ASSERT_TRUE(pass.indices_ok);
        EXPECT_EQ(pass.touches, kTouchesAll);
        EXPECT_EQ(pass.references[0], expected.at[static_cast<std::size_t>(depth)]);
        EXPECT_EQ(pass.references[1], expected.at[static_cast<std::size_t>(depth / 2)]);
      }
      EXPECT_EQ(count_references(boxes, schedule).at, expected.at);
      for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
        const CellBox box = finest_cells_of(quantisers, mesh.triangle(t));
        for (std::size_t a = 0; a < 3; ++a) {
          ASSERT_EQ(boxes[t].lo[a], box.lo[a]);
          ASSERT_EQ(boxes[t].hi[a], box.hi[a]);
        }
      }
    }
  }
}

TEST(TriangleBoxes, NoticeABadIndexAndVerticesNobodyUses) {
  test::OwnedMesh owned = test::sheet(20, 0.2f);
  const Box3 bounds = reference::scene_bound(owned.view()).value();
  const AxisLevels schedule = make_axis_levels(bounds, AxisSchedule::cyclic);
  std::vector<VertexCell> cells(owned.positions.size());
  std::vector<TriangleBox> boxes;
  EXPECT_EQ(box_triangles(owned.view(), cells, schedule, {5, 1}, boxes).touches, 0);
  owned.indices[701] = static_cast<std::uint32_t>(owned.positions.size());
  EXPECT_FALSE(box_triangles(owned.view(), cells, schedule, {5, 1}, boxes).indices_ok);
}

}  // namespace
}  // namespace fasttree::build
