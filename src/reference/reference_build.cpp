// SPDX-License-Identifier: Apache-2.0
#include "reference/reference_build.h"

#include <algorithm>
#include <string>

#include "reference/radix_sort.h"
#include "reference/scene_bound.h"
#include "support/stage_clock.h"

namespace fasttree::reference {
namespace {

// The most the arrays can take for M references at depth D: there are no more leaves than cells or
// references. Counted are the arrays below, the sort's second buffer and counters, the bitmap with
// its ranks, the device image and the tree made of it.
std::uint64_t planned_bytes(std::uint64_t references, int depth) {
  const std::uint64_t leaves = std::min(references, std::uint64_t{1} << depth);
  const std::uint64_t per_reference = 3 * 8 + 2 + 2 * 4;
  const std::uint64_t per_leaf = 20 + 12 + 16 + (8 + 16) + 16;
  const std::uint64_t bitmap = (std::uint64_t{1} << (depth + 1)) / 8 * 2;
  return references * per_reference + leaves * per_leaf + bitmap;
}

Status over_memory_limit(std::uint64_t planned, std::uint64_t limit, std::uint64_t references,
                         int depth) {
  return {StatusCode::resource_limit,
          "building at depth " + std::to_string(depth) + " with " + std::to_string(references) +
              " references may take " + std::to_string(planned) + " bytes, over the limit of " +
              std::to_string(limit) + ". Raise the limit or ask for a smaller depth."};
}

}  // namespace

Result<ReferenceBuild> build(const MeshView& mesh, const BuildSettings& settings,
                             BuildStats& stats) {
  if (Status status = validate(mesh); !status.ok()) return status;
  StageClock clock(settings.progress, stats.stages);
  ReferenceBuild b;
  b.triangle_count = mesh.triangle_count;
  Status failure;

  clock.stage("scene_bound", 0.00, 0.05, [&] {
    Result<Box3> bounds = scene_bound(mesh);
    failure = bounds.status();
    if (bounds.ok()) b.bounds = bounds.value();
  });
  if (!failure.ok()) return failure;

  clock.stage("grid", 0.05, 0.15, [&] {
    b.counts = count_references(mesh, b.bounds, settings.axes);
    const Result<int> depth = choose_depth(b.counts, mesh.triangle_count, settings);
    failure = depth.status();
    if (!depth.ok()) return;
    const std::uint64_t references = b.counts.at[static_cast<std::size_t>(depth.value())];
    stats.planned_bytes = planned_bytes(references, depth.value());
    if (settings.memory_limit_bytes != 0 && stats.planned_bytes > settings.memory_limit_bytes) {
      failure = over_memory_limit(stats.planned_bytes, settings.memory_limit_bytes, references,
                                  depth.value());
      return;
    }
    b.grid = Grid(b.bounds, settings.axes, depth.value());
  });
  if (!failure.ok()) return failure;

  clock.stage("morton_code", 0.15, 0.25, [&] {
    b.references = morton_code(mesh, b.grid, b.counts.at[static_cast<std::size_t>(b.grid.depth())]);
  });
  clock.stage("radix_sort", 0.25, 0.80, [&] {
    b.sorted =
        radix_sort(b.references, [&](int round) { return clock.report((round + 1.0) / kRounds); });
  });
  clock.stage("leaf_node", 0.80, 0.82, [&] { b.leaves = leaf_node(b.sorted); });
  clock.stage("internal_node", 0.82, 0.86, [&] { b.internal = internal_node(b.leaves, b.grid); });
  clock.stage("bit_encoding", 0.86, 0.90,
              [&] { b.essential = bit_encoding(b.internal, b.grid.depth()); });
  clock.stage("path_compression", 0.90, 1.00, [&] {
    b.links = path_compression(b.leaves, b.internal, b.essential, b.grid.depth());
  });
  if (clock.cancelled()) return clock.cancelled_status();

  stats.triangles = b.triangle_count;
  stats.references = b.sorted.size();
  return b;
}

DeviceImage device_image(const ReferenceBuild& build) {
  DeviceImage image;
  image.info = build.grid.tree_info(build.triangle_count);
  image.root = build.links.root;
  image.leaves.resize(std::max<std::size_t>(build.leaves.size(), 1));
  for (std::size_t j = 0; j < build.leaves.size(); ++j) {
    image.leaves[j] = {build.leaves.first[j], build.leaves.count[j]};
  }
  image.internal.resize(build.internal.size());
  for (std::size_t j = 0; j < build.internal.size(); ++j) {
    image.internal[j] = {build.links.lower[j], build.links.upper[j], build.internal.split[j],
                         build.internal.axis[j]};
  }
  image.ids = build.sorted.ids;
  return image;
}

}  // namespace fasttree::reference
