// SPDX-License-Identifier: Apache-2.0
#include "build/triangle_boxes.h"

#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace fasttree::build {
namespace {

constexpr std::uint32_t kTrianglesPerTask = 4096;

// The range of three vertices' cells, lane by lane.
TriangleBox box_of(const VertexCell& a, const VertexCell& b, const VertexCell& c) {
  TriangleBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.lo[k] = std::min({a.q[k], b.q[k], c.q[k]});
    box.hi[k] = std::max({a.q[k], b.q[k], c.q[k]});
  }
  return box;
}

// Number of cells of a box, given how far each axis is shifted from the finest grid.
std::uint64_t cells_of(const TriangleBox& box, const std::array<int, 3>& shift) {
  std::uint32_t cells = 1;  // at most 2^30
  for (std::size_t a = 0; a < 3; ++a) {
    cells *= static_cast<std::uint32_t>((box.hi[a] >> shift[a]) - (box.lo[a] >> shift[a]) + 1);
  }
  return cells;
}

template <typename Work>
void for_each_range(std::uint32_t triangles, const Work& work) {
  tbb::parallel_for(
      tbb::blocked_range<std::uint32_t>(0, triangles, kTrianglesPerTask),
      [&](const tbb::blocked_range<std::uint32_t>& range) { work(range.begin(), range.end()); });
}

}  // namespace

BoxPass box_triangles(const MeshView& mesh, std::span<const VertexCell> cells,
                      const AxisLevels& schedule, std::array<int, 2> depths,
                      std::vector<TriangleBox>& boxes) {
  boxes.resize(mesh.triangle_count);
  std::array<std::array<int, 3>, 2> shifts;
  for (std::size_t d = 0; d < 2; ++d) {
    const auto bits = schedule.bits(depths[d]);
    for (std::size_t a = 0; a < 3; ++a) shifts[d][a] = kMaxAxisBits - bits[a];
  }
  tbb::combinable<BoxPass> parts;
  for_each_range(mesh.triangle_count, [&](std::uint32_t first, std::uint32_t end) {
    BoxPass part;
    unsigned touches = 0;
    for (std::uint32_t t = first; t < end; ++t) {
      const std::uint32_t v0 = mesh.vertex_index(t, 0);
      const std::uint32_t v1 = mesh.vertex_index(t, 1);
      const std::uint32_t v2 = mesh.vertex_index(t, 2);
      if (std::max({v0, v1, v2}) >= cells.size()) {
        parts.local().indices_ok = false;
        return;
      }
      const TriangleBox box = box_of(cells[v0], cells[v1], cells[v2]);
      boxes[t] = box;
      touches |= static_cast<unsigned>(cells[v0].touches | cells[v1].touches | cells[v2].touches);
      for (std::size_t d = 0; d < 2; ++d) part.references[d] += cells_of(box, shifts[d]);
    }
    BoxPass& all = parts.local();
    all.touches = static_cast<std::uint16_t>(all.touches | touches);
    for (std::size_t d = 0; d < 2; ++d) all.references[d] += part.references[d];
  });
  BoxPass all;
  parts.combine_each([&](const BoxPass& part) {
    for (std::size_t d = 0; d < 2; ++d) all.references[d] += part.references[d];
    all.indices_ok = all.indices_ok && part.indices_ok;
    all.touches = static_cast<std::uint16_t>(all.touches | part.touches);
  });
  return all;
}

ReferenceCounts count_references(std::span<const TriangleBox> boxes, const AxisLevels& schedule) {
  tbb::combinable<ReferenceCounts> parts;
  for_each_range(static_cast<std::uint32_t>(boxes.size()), [&](std::uint32_t first,
                                                               std::uint32_t end) {
    ReferenceCounts& part = parts.local();
    for (std::uint32_t t = first; t < end; ++t) {
      const TriangleBox& box = boxes[t];
      part.add(schedule, {{box.lo[0], box.lo[1], box.lo[2]}, {box.hi[0], box.hi[1], box.hi[2]}});
    }
  });
  ReferenceCounts all;
  parts.combine_each([&](const ReferenceCounts& part) { all.add(part); });
  all.levels = schedule.levels;
  return all;
}

}  // namespace fasttree::build
