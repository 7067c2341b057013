// SPDX-License-Identifier: Apache-2.0
#include "reference/morton_code.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/support/meshes.h"

namespace fasttree::reference {
namespace {

TEST(MortonCode, PutsATriangleIntoEveryCellOfItsBox) {
  test::OwnedMesh owned;
  owned.add({0, 0, 0}, {4, 4, 4}, {4, 0, 0});                             // every cell
  owned.add({0.5f, 2.5f, 1.5f}, {1.5f, 2.5f, 1.5f}, {0.5f, 2.6f, 1.5f});  // two cells
  const Grid grid({{0, 0, 0}, {4, 4, 4}}, AxisSchedule::cyclic, 6);
  const References refs = morton_code(owned.view(), grid, 66);
  ASSERT_EQ(refs.size(), 66u);
  // x fastest, then y, then z.
  EXPECT_EQ(refs.codes[0], grid.morton_code({0, 0, 0}));
  EXPECT_EQ(refs.codes[1], grid.morton_code({1, 0, 0}));
  EXPECT_EQ(refs.codes[4], grid.morton_code({0, 1, 0}));
  EXPECT_EQ(refs.codes[16], grid.morton_code({0, 0, 1}));
  EXPECT_EQ(refs.codes[64], grid.morton_code({0, 2, 1}));
  EXPECT_EQ(refs.codes[65], grid.morton_code({1, 2, 1}));
  EXPECT_EQ(refs.ids[63], 0u);
  EXPECT_EQ(refs.ids[64], 1u);
}

TEST(MortonCode, ACoordinateOnAPlaneBelongsToTheUpperCell) {
  test::OwnedMesh owned;
  owned.add({1, 1, 1}, {2, 1, 1}, {1, 1.5f, 1});
  const Grid grid({{0, 0, 0}, {4, 4, 4}}, AxisSchedule::cyclic, 6);
  const CellBox box = grid.cells_of(owned.view().triangle(0));
  EXPECT_EQ(box.lo, (Cell{1, 1, 1}));
  EXPECT_EQ(box.hi, (Cell{2, 1, 1}));
}

// Brute force: a triangle is in a cell exactly when its box, as half-open ranges of coordinates,
// meets the cell's range between its planes.
TEST(MortonCode, EqualsTheOverlapOfBoxesAndCells) {
  const test::OwnedMesh owned = test::snapped_soup(60, 5, 8);
  const MeshView mesh = owned.view();
  const Grid grid({{0, 0, 0}, {1, 1, 1}}, AxisSchedule::longest, 7);
  std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
  for (std::uint32_t code = 0; code < 128; ++code) {
    const Cell cell = grid.cell_of(code);
    for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
      Box3 box;
      for (const Vec3& p : mesh.triangle(t)) box.include(p);
      bool inside = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const bool last = cell[a] + 1 == 1u << grid.bits()[a];
        inside = inside && (cell[a] == 0 || box.hi[a] >= grid.plane(a, cell[a]));
        inside = inside && (last || box.lo[a] < grid.plane(a, cell[a] + 1));
      }
      if (inside) expected.insert({code, t});
    }
  }
  const References refs = morton_code(mesh, grid, expected.size());
  std::set<std::pair<std::uint32_t, std::uint32_t>> found;
  for (std::size_t i = 0; i < refs.size(); ++i) found.insert({refs.codes[i], refs.ids[i]});
  EXPECT_EQ(found.size(), refs.size()) << "no reference twice";
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace fasttree::reference
