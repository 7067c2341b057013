// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set by Highway's foreach_target; the plain C++ forms and the
// choice between them stand at the end.
#include "build/triangle_boxes.h"

#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "build/triangle_boxes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#ifndef FASTTREE_TRIANGLE_BOXES_ONCE
#define FASTTREE_TRIANGLE_BOXES_ONCE
namespace fasttree::build {

inline constexpr std::uint32_t kBlock = 256;

// Corners of a block's boxes as structure of arrays, for counting.
struct BoxBlock {
  alignas(64) std::uint32_t lo[3][kBlock];
  alignas(64) std::uint32_t hi[3][kBlock];
  std::uint32_t count = 0;
};

}  // namespace fasttree::build
#endif

HWY_BEFORE_NAMESPACE();
namespace fasttree::build {
namespace HWY_NAMESPACE {

// Plain loops: the compiler vectorises them for the target this is compiled for.
void CountReferences(const BoxBlock& boxes, const AxisLevels& schedule, int levels,
                     ReferenceCounts& counts) {
  alignas(64) std::uint32_t cells[3][kBlock];
  for (auto& axis : cells) std::fill(axis, axis + kBlock, 1u);
  std::array<int, 3> bits{};
  counts.at[0] += boxes.count;
  for (int level = 0; level < levels; ++level) {
    const std::size_t a = schedule.axis[static_cast<std::size_t>(level)];
    const int shift = kMaxAxisBits - ++bits[a];
    std::uint64_t sum = 0;
    for (std::uint32_t i = 0; i < boxes.count; ++i) {
      cells[a][i] = (boxes.hi[a][i] >> shift) - (boxes.lo[a][i] >> shift) + 1;
      sum += cells[0][i] * cells[1][i] * cells[2][i];  // at most 2^30
    }
    counts.at[static_cast<std::size_t>(level) + 1] += sum;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace fasttree::build
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree::build {

HWY_EXPORT(CountReferences);

namespace {

void count_references(Simd simd, const BoxBlock& boxes, const AxisLevels& schedule, int levels,
                      ReferenceCounts& counts) {
  if (simd == Simd::widest) {
    return HWY_DYNAMIC_DISPATCH(CountReferences)(boxes, schedule, levels, counts);
  }
  AxisLevels first_levels = schedule;
  first_levels.levels = levels;
  for (std::uint32_t i = 0; i < boxes.count; ++i) {
    counts.add(first_levels, {{boxes.lo[0][i], boxes.lo[1][i], boxes.lo[2][i]},
                              {boxes.hi[0][i], boxes.hi[1][i], boxes.hi[2][i]}});
  }
}

// The range of three vertices' cells, lane by lane; four lanes of 16 bits are one machine word, and
// the compiler makes one vector instruction of each loop.
TriangleBox box_of(const VertexCell& a, const VertexCell& b, const VertexCell& c) {
  TriangleBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.lo[k] = std::min({a.q[k], b.q[k], c.q[k]});
    box.hi[k] = std::max({a.q[k], b.q[k], c.q[k]});
  }
  return box;
}

}  // namespace

BoxPass box_triangles(const MeshView& mesh, std::span<const VertexCell> cells,
                      const AxisLevels& schedule, int levels, Simd simd,
                      std::vector<TriangleBox>& boxes) {
  boxes.resize(mesh.triangle_count);
  tbb::combinable<BoxPass> parts;
  const std::uint32_t blocks = (mesh.triangle_count + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, blocks, 16),
                    [&](const tbb::blocked_range<std::uint32_t>& range) {
                      BoxPass& part = parts.local();
                      BoxBlock block;
                      for (std::uint32_t b = range.begin(); b < range.end(); ++b) {
                        const std::uint32_t first = b * kBlock;
                        block.count = std::min(kBlock, mesh.triangle_count - first);
                        for (std::uint32_t i = 0; i < block.count; ++i) {
                          const std::uint32_t t = first + i;
                          const std::uint32_t v0 = mesh.vertex_index(t, 0);
                          const std::uint32_t v1 = mesh.vertex_index(t, 1);
                          const std::uint32_t v2 = mesh.vertex_index(t, 2);
                          if (std::max({v0, v1, v2}) >= cells.size()) {
                            part.indices_ok = false;
                            return;
                          }
                          const TriangleBox box = box_of(cells[v0], cells[v1], cells[v2]);
                          boxes[t] = box;
                          part.touches =
                              static_cast<std::uint16_t>(part.touches | cells[v0].touches |
                                                         cells[v1].touches | cells[v2].touches);
                          for (std::size_t a = 0; a < 3; ++a) {
                            block.lo[a][i] = box.lo[a];
                            block.hi[a][i] = box.hi[a];
                          }
                        }
                        count_references(simd, block, schedule, levels, part.counts);
                      }
                    });
  BoxPass all;
  parts.combine_each([&](const BoxPass& part) {
    all.counts.add(part.counts);
    all.indices_ok = all.indices_ok && part.indices_ok;
    all.touches = static_cast<std::uint16_t>(all.touches | part.touches);
  });
  all.counts.levels = levels;
  return all;
}

}  // namespace fasttree::build
#endif  // HWY_ONCE
