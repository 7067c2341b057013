// SPDX-License-Identifier: Apache-2.0
#include "reference/layer.h"

#include <algorithm>
#include <bit>
#include <map>

#include "grid/cell_overlap.h"
#include "grid/realtime_rule.h"

namespace fasttree::reference {
namespace {

// The part of the cell where the triangles are.
Box3 box_of(const MeshView& mesh, const LayerList& list) {
  Box3 box;
  for (const std::uint32_t id : list.ids) {
    for (const Vec3& corner : mesh.triangle(id)) box.include(corner);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    box.lo[a] = std::max(box.lo[a], list.cell.lo[a]);
    box.hi[a] = std::min(box.hi[a], list.cell.hi[a]);
  }
  return box;
}

std::uint64_t references_of_boxes(const MeshView& mesh, const LayerList& list, const Grid& grid) {
  std::uint64_t references = 0;
  for (const std::uint32_t id : list.ids) references += grid.cells_of(mesh.triangle(id)).count();
  return references;
}

// The deepest grid that the rule allows.
Grid choose_grid(const MeshView& mesh, const LayerList& list, const Box3& box) {
  const auto size = static_cast<std::uint32_t>(list.ids.size());
  const int log2 = std::bit_width(size - 1);  // ceil(log2 n)
  int depth = std::min(
      {log2 + kRealtimeRule.layer_extra_depth, kRealtimeRule.layer_most_depth, list.levels_left});
  const std::uint64_t limit =
      std::min(std::uint64_t{kRealtimeRule.layer_growth} * size, list.budget);
  while (true) {
    Grid grid(box, AxisSchedule::longest, depth);
    if (grid.depth() == 0 || references_of_boxes(mesh, list, grid) <= limit) return grid;
    depth = grid.depth() - 1;
  }
}

// Calls put(code) for each cell that gets the triangle.
template <typename Put>
void for_each_cell(const Grid& grid, const std::array<Vec3, 3>& triangle, const Put& put) {
  const CellBox box = grid.cells_of(triangle);
  int axes = 0;
  for (std::size_t a = 0; a < 3; ++a) axes += box.hi[a] > box.lo[a];
  const CellOverlap overlap(in_cells(grid, triangle), box.lo);
  for (std::uint32_t z = box.lo[2]; z <= box.hi[2]; ++z) {
    for (std::uint32_t y = box.lo[1]; y <= box.hi[1]; ++y) {
      for (std::uint32_t x = box.lo[0]; x <= box.hi[0]; ++x) {
        if (axes < 2 ||
            overlap.at(static_cast<float>(x - box.lo[0]), static_cast<float>(y - box.lo[1]),
                       static_cast<float>(z - box.lo[2]))) {
          put(grid.morton_code({x, y, z}));
        }
      }
    }
  }
}

double half_area(const Box3& box, const std::array<std::uint8_t, 3>& bits) {
  const double x = static_cast<double>(box.hi.x - box.lo.x) / (1 << bits[0]);
  const double y = static_cast<double>(box.hi.y - box.lo.y) / (1 << bits[1]);
  const double z = static_cast<double>(box.hi.z - box.lo.z) / (1 << bits[2]);
  return (x * y + y * z) + z * x;
}

Box3 cell_of(const Grid& grid, std::uint32_t code, const Box3& parent) {
  Box3 cell = parent;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t k = grid.coordinate_of(code, a);
    if (k > 0) cell.lo[a] = grid.plane(a, k);
    if (k + 1 < 1u << grid.bits()[a]) cell.hi[a] = grid.plane(a, k + 1);
  }
  return cell;
}

}  // namespace

Layer make_layer(const MeshView& mesh, const LayerList& list) {
  const std::size_t size = list.ids.size();
  if (size <= kRealtimeRule.leaf_size || list.layer == kRealtimeRule.most_layers) return {};
  const Box3 box = box_of(mesh, list);
  Layer layer;
  layer.grid = choose_grid(mesh, list, box);
  if (layer.grid.depth() == 0) return {};

  std::map<std::uint32_t, std::vector<std::uint32_t>> cells;
  std::uint64_t kept = 0;
  for (const std::uint32_t id : list.ids) {
    for_each_cell(layer.grid, mesh.triangle(id), [&](std::uint32_t code) {
      cells[code].push_back(id);
      ++kept;
    });
  }
  const bool helps = std::any_of(cells.begin(), cells.end(),
                                 [&](const auto& cell) { return cell.second.size() < size; });
  if (!helps) return {};
  const double cost = static_cast<double>(kept) * half_area(box, layer.grid.bits());
  const double of_a_leaf = static_cast<double>(size) * half_area(box, {0, 0, 0});
  if (cost > kRealtimeRule.worth * of_a_leaf) return {};

  for (auto& [code, ids] : cells) {
    LayerList child;
    child.cell = cell_of(layer.grid, code, list.cell);
    child.budget = list.budget * ids.size() / kept;
    child.layer = list.layer + 1;
    child.levels_left = list.levels_left - layer.grid.depth();
    child.ids = std::move(ids);
    layer.code.push_back(code);
    layer.children.push_back(std::move(child));
  }
  return layer;
}

}  // namespace fasttree::reference
