// SPDX-License-Identifier: Apache-2.0
#include "build/morton_build.h"

#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <utility>

#include "build/node_emission.h"
#include "build/radix_sort.h"
#include "reference/scene_bound.h"
#include "support/stage_clock.h"

namespace fasttree::build {
namespace {

constexpr std::size_t kLeafChunk = std::size_t{1} << 15;  // references one task looks over

std::uint32_t block_count(std::uint32_t triangles) {
  return (triangles + kBlock - 1) / kBlock;
}

// Calls work(block, first triangle, count) for every block of triangles, in parallel.
template <typename Work>
void for_each_block(std::uint32_t triangles, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, block_count(triangles), 4),
                    [&](const tbb::blocked_range<std::uint32_t>& range) {
                      for (std::uint32_t b = range.begin(); b < range.end(); ++b) {
                        work(b, b * kBlock, std::min(kBlock, triangles - b * kBlock));
                      }
                    });
}

Result<Box3> parallel_scene_bound(const MeshView& mesh, Simd simd) {
  if (mesh.triangle_count == 0) return reference::scene_bound(mesh);
  tbb::combinable<Box3> bounds;
  std::atomic<bool> finite = true;
  for_each_block(mesh.triangle_count, [&](std::uint32_t, std::uint32_t first, std::uint32_t count) {
    TriangleBlock block;
    gather(mesh, first, count, block);
    if (!scene_bound(simd, block, bounds.local())) finite.store(false, std::memory_order_relaxed);
  });
  Box3 all = bounds.combine([](Box3 a, const Box3& b) {
    a.include(b.lo);
    a.include(b.hi);
    return a;
  });
  for (std::size_t a = 0; a < 3; ++a) {
    all.lo[a] += 0.0f;  // minus zero becomes plus zero
    all.hi[a] += 0.0f;
    if (!std::isfinite(all.hi[a] - all.lo[a])) finite = false;
  }
  // The reference knows how to say what is wrong, and where.
  if (!finite) return reference::scene_bound(mesh);
  return all;
}

// Quantises every triangle's box and counts M(D) up to `levels`.
ReferenceCounts quantise_and_count(const MeshView& mesh, const AxisLevels& schedule,
                                   const std::array<AxisQuantiser, 3>& quantisers, int levels,
                                   Simd simd, std::vector<StoredBox>& stored) {
  tbb::combinable<ReferenceCounts> counts;
  for_each_block(mesh.triangle_count, [&](std::uint32_t, std::uint32_t first, std::uint32_t count) {
    TriangleBlock block;
    BoxBlock boxes;
    gather(mesh, first, count, block);
    quantise(simd, block, quantisers, boxes);
    count_references(simd, boxes, schedule, levels, counts.local());
    for (std::uint32_t i = 0; i < count; ++i) {
      for (std::size_t a = 0; a < 3; ++a) {
        stored[first + i].lo[a] = static_cast<std::uint16_t>(boxes.lo[a][i]);
        stored[first + i].hi[a] = static_cast<std::uint16_t>(boxes.hi[a][i]);
      }
    }
  });
  ReferenceCounts all;
  counts.combine_each([&](const ReferenceCounts& part) { all.add(part); });
  all.levels = levels;
  return all;
}

CellBox cells_at(const Grid& grid, const StoredBox& box) {
  CellBox cells;
  for (std::size_t a = 0; a < 3; ++a) {
    cells.lo[a] = static_cast<std::uint32_t>(box.lo[a] >> (kMaxAxisBits - grid.bits()[a]));
    cells.hi[a] = static_cast<std::uint32_t>(box.hi[a] >> (kMaxAxisBits - grid.bits()[a]));
  }
  return cells;
}

// Writes all references in order of triangle, x, y, z. Each block's place is known from a prefix
// sum over the blocks' counts.
void emit_references(const std::vector<StoredBox>& boxes, const Grid& grid,
                     std::vector<std::uint64_t>& block_references, ReferenceSpan out) {
  const auto triangles = static_cast<std::uint32_t>(boxes.size());
  block_references.resize(block_count(triangles));
  for_each_block(triangles, [&](std::uint32_t b, std::uint32_t first, std::uint32_t count) {
    std::uint64_t references = 0;
    for (std::uint32_t i = 0; i < count; ++i)
      references += cells_at(grid, boxes[first + i]).count();
    block_references[b] = references;
  });
  std::uint64_t begin = 0;
  for (std::uint64_t& references : block_references) begin += std::exchange(references, begin);

  for_each_block(triangles, [&](std::uint32_t b, std::uint32_t first, std::uint32_t count) {
    std::uint64_t to = block_references[b];
    for (std::uint32_t i = 0; i < count; ++i) {
      const CellBox box = cells_at(grid, boxes[first + i]);
      for (std::uint32_t z = box.lo[2]; z <= box.hi[2]; ++z) {
        for (std::uint32_t y = box.lo[1]; y <= box.hi[1]; ++y) {
          for (std::uint32_t x = box.lo[0]; x <= box.hi[0]; ++x) {
            out.codes[to] = grid.morton_code({x, y, z});
            out.ids[to++] = first + i;
          }
        }
      }
    }
  });
}

// Finds the runs of equal codes, in parallel over chunks of references.
void find_leaves(std::span<const std::uint32_t> codes, Workspace& w) {
  const std::size_t chunks = (codes.size() + kLeafChunk - 1) / kLeafChunk;
  const auto for_each_start = [&](std::size_t chunk, auto&& work) {
    const std::size_t end = std::min(codes.size(), (chunk + 1) * kLeafChunk);
    for (std::size_t i = chunk * kLeafChunk; i < end; ++i) {
      if (i == 0 || codes[i - 1] != codes[i]) work(i);
    }
  };
  w.chunk_leaves.resize(chunks);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    std::uint64_t leaves = 0;
    for_each_start(chunk, [&](std::size_t) { ++leaves; });
    w.chunk_leaves[chunk] = leaves;
  });
  std::uint64_t begin = 0;
  for (std::uint64_t& leaves : w.chunk_leaves) begin += std::exchange(leaves, begin);
  w.leaf_codes.resize(begin);
  w.leaf_first.resize(begin);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    std::uint64_t leaf = w.chunk_leaves[chunk];
    for_each_start(chunk, [&](std::size_t i) {
      w.leaf_codes[leaf] = codes[i];
      w.leaf_first[leaf++] = static_cast<std::uint32_t>(i);
    });
  });
}

// Bytes of the workspace and the tree for M references at depth D.
std::uint64_t planned_bytes(std::uint64_t triangles, std::uint64_t references, int depth) {
  const std::uint64_t leaves = std::min(references, std::uint64_t{1} << depth);
  return triangles * sizeof(StoredBox) + references * (4 * 4) + references / 16 +
         leaves * (8 + 2 * sizeof(Node)) + (std::uint64_t{1} << 20);
}

Status check_memory(std::uint64_t planned, std::uint64_t limit, const std::string& what) {
  if (limit == 0 || planned <= limit) return {};
  return {StatusCode::resource_limit, what + " may take " + std::to_string(planned) +
                                          " bytes, over the limit of " + std::to_string(limit) +
                                          ". Raise the limit or ask for a smaller depth."};
}

}  // namespace

Status morton_build(const MeshView& mesh, const BuildSettings& settings, Workspace& w,
                    TreeArrays& tree, BuildStats& stats) {
  if (Status status = validate(mesh); !status.ok()) return status;
  if (Status status = check_memory(
          planned_bytes(mesh.triangle_count, mesh.triangle_count, 0), settings.memory_limit_bytes,
          "building from " + std::to_string(mesh.triangle_count) + " triangles");
      !status.ok()) {
    return status;
  }
  StageClock clock(settings.progress, stats.stages);
  Status failure;
  Box3 bounds;
  Grid grid;
  std::uint64_t references = 0;

  clock.stage("scene_bound", 0.0, 0.1, [&] {
    const Result<Box3> result = parallel_scene_bound(mesh, settings.simd);
    failure = result.status();
    if (result.ok()) bounds = result.value();
  });
  if (!failure.ok()) return failure;

  clock.stage("grid", 0.1, 0.3, [&] {
    const AxisLevels schedule = make_axis_levels(bounds, settings.axes);
    const std::array<AxisQuantiser, 3> quantisers{make_axis_quantiser(bounds, schedule, 0),
                                                  make_axis_quantiser(bounds, schedule, 1),
                                                  make_axis_quantiser(bounds, schedule, 2)};
    w.boxes.resize(mesh.triangle_count);
    const ReferenceCounts counts =
        quantise_and_count(mesh, schedule, quantisers, schedule.levels, settings.simd, w.boxes);
    const Result<int> depth = choose_depth(counts, mesh.triangle_count, settings);
    failure = depth.status();
    if (!depth.ok()) return;
    references = counts.at[static_cast<std::size_t>(depth.value())];
    stats.planned_bytes = planned_bytes(mesh.triangle_count, references, depth.value());
    failure = check_memory(stats.planned_bytes, settings.memory_limit_bytes,
                           "building at depth " + std::to_string(depth.value()) + " with " +
                               std::to_string(references) + " references");
    if (failure.ok()) grid = Grid(bounds, settings.axes, depth.value());
  });
  if (!failure.ok()) return failure;

  // The sort ends in the tree's own ids.
  const bool even = radix_sort_rounds(grid.depth()) % 2 == 0;
  ReferenceSpan unsorted, other;
  clock.stage("morton_code", 0.3, 0.5, [&] {
    for (auto& codes : w.codes) codes.resize(references);
    w.ids.resize(references);
    tree.ids.resize(references);
    unsorted = {w.codes[0], even ? tree.ids : w.ids};
    other = {w.codes[1], even ? w.ids : tree.ids};
    emit_references(w.boxes, grid, w.block_references, unsorted);
  });
  clock.stage("radix_sort", 0.5, 0.9,
              [&] { radix_sort(unsorted, other, grid.depth(), w.sort_counters); });
  clock.stage("leaf_node", 0.9, 0.95, [&] { find_leaves(w.codes[even ? 0 : 1], w); });
  clock.stage("node_emission", 0.95, 1.0, [&] {
    if (references == 0) {
      tree.nodes.assign(1, Node::leaf(0, 0));
      return;
    }
    tree.nodes.resize(2 * w.leaf_codes.size() - 1);
    emit_nodes(w.leaf_codes, w.leaf_first, static_cast<std::uint32_t>(references), grid,
               tree.nodes);
  });
  if (clock.cancelled()) return clock.cancelled_status();

  tree.info = grid.tree_info(mesh.triangle_count);
  stats.triangles = mesh.triangle_count;
  stats.references = references;
  return {};
}

}  // namespace fasttree::build
