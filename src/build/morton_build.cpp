// SPDX-License-Identifier: Apache-2.0
#include "build/morton_build.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <string>

#include "build/node_emission.h"
#include "geometry/mesh_checks.h"
#include "reference/scene_bound.h"
#include "support/stage_clock.h"

namespace fasttree::build {
namespace {

// Each costs the pass over the vertices the end of a vector.
constexpr std::size_t kMostStrays = 4096;

// Bytes of the workspace and the tree: what every mesh takes, and what M references take, of which
// `records` are partitioned.
std::uint64_t mesh_bytes(const MeshView& mesh) {
  return kMostStrays * sizeof(std::uint32_t) + mesh.vertex_count * sizeof(std::uint32_t) +
         mesh.triangle_count * sizeof(CodeBox);
}

std::uint64_t tree_bytes(const MeshView& mesh, std::uint64_t references, std::uint64_t records,
                         const BucketGrid& grid) {
  const std::uint64_t leaves = std::min(references, std::uint64_t{1} << grid.axes().depth);
  return records * sizeof(BucketGrid::Record) + references * sizeof(std::uint32_t) +
         leaves * (sizeof(LeafStart) + 2 * sizeof(Node)) +
         partition_bytes(mesh.triangle_count, grid) + scratch_bytes(grid);
}

Status check_memory(std::uint64_t planned, std::uint64_t limit, const std::string& what) {
  if (limit == 0 || planned <= limit) return {};
  return {StatusCode::resource_limit, what + " may take " + std::to_string(planned) +
                                          " bytes, over the limit of " + std::to_string(limit) +
                                          ". Raise the limit or ask for a smaller depth."};
}

// The deepest D that the depth rule can choose.
int deepest(const AxisLevels& schedule, std::uint32_t triangles, const BuildSettings& settings) {
  if (settings.depth != kAutoDepth) return std::clamp(settings.depth, 0, schedule.levels);
  const int log2 = std::bit_width(std::max(triangles, 1u) - 1);
  return std::clamp(log2 + std::clamp(settings.extra_depth, -kMaxDepth, kMaxDepth), 0,
                    std::min(schedule.levels, kMaxAutoDepth));
}

// Steps 1 and 2 up to M(D): the scene's bounds, and the cells of all boxes.
struct Gridded {
  Box3 bounds;
  AxisLevels schedule;
  int box_depth = 0;             // of the boxes: the deepest that may be chosen
  int depth = 0;                 // the one that is
  std::uint64_t references = 0;  // M(depth)
};

BoxPass grid_triangles(const MeshView& mesh, const BuildSettings& settings, Workspace& w,
                       Gridded& g) {
  g.schedule = make_axis_levels(g.bounds, settings.axes);
  g.depth = g.box_depth = deepest(g.schedule, mesh.triangle_count, settings);
  const VertexEncoder encoder(g.bounds, g.schedule, g.box_depth);
  encode_vertices(mesh, encoder, settings.simd, w.vertex_codes);
  const BoxPass pass =
      box_triangles(mesh, g.bounds, w.vertex_codes, encoder.axes, settings.simd, w.boxes);
  g.references = pass.references;
  return pass;
}

// The depth rule. M grows with D, so where the deepest D keeps the rule no other has to be counted.
Status settle_depth(std::uint32_t triangles, const BuildSettings& settings, const Workspace& w,
                    Gridded& g) {
  ReferenceCounts counts;
  counts.levels = g.depth;
  counts.at[static_cast<std::size_t>(g.depth)] = g.references;
  Result<int> depth = choose_depth(counts, triangles, settings);
  if (depth.ok() && depth.value() == g.depth) return {};
  if (!depth.ok() && depth.status().code() == StatusCode::invalid_argument) return depth.status();
  counts = count_references(w.boxes, g.schedule, g.box_depth);
  depth = choose_depth(counts, triangles, settings);
  if (!depth.ok()) return depth.status();
  g.depth = depth.value();
  g.references = counts.at[static_cast<std::size_t>(g.depth)];
  return {};
}

// The bounds by going over the triangles: for a mesh some of whose vertices no triangle uses, and
// for saying what is wrong, and where. Such vertices will mostly be the same in the next frame, so
// they are remembered.
Status bounds_of_triangles(const MeshView& mesh, Workspace& w, Box3& bounds) {
  w.strays.clear();
  if (Status status = validate(mesh); !status.ok()) return status;
  const Result<Box3> result = reference::scene_bound(mesh);
  if (!result.ok()) return result.status();
  bounds = result.value();
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
    const Vec3 p = mesh.position(v);
    const auto within = [&](std::size_t a) { return p[a] >= bounds.lo[a] && p[a] <= bounds.hi[a]; };
    if (within(0) && within(1) && within(2)) continue;
    if (w.strays.size() == kMostStrays) {
      w.strays.clear();
      break;
    }
    w.strays.push_back(v);
  }
  return {};
}

}  // namespace

Status sort_into_leaves(const MeshView& whole_mesh, const BuildSettings& settings,
                        std::uint64_t more_bytes_per_reference, double share, StageClock& clock,
                        Workspace& w, Buffer<std::uint32_t>& ids, BuildStats& stats,
                        SortedLeaves& sorted) {
  if (Status status = validate_shape(whole_mesh); !status.ok()) return status;
  MeshView mesh = whole_mesh;
  if (mesh.triangle_count == 0) mesh.vertex_count = 0;  // nobody has looked at its vertices
  if (Status status =
          check_memory(mesh_bytes(mesh), settings.memory_limit_bytes,
                       "building from " + std::to_string(mesh.triangle_count) + " triangles");
      !status.ok()) {
    return status;
  }
  Status failure;
  Gridded g;
  Grid& grid = sorted.grid;
  BucketGrid& bucket_grid = sorted.buckets;
  const auto plan = [&](std::uint64_t records) {
    stats.planned_bytes = mesh_bytes(mesh) + tree_bytes(mesh, g.references, records, bucket_grid) +
                          more_bytes_per_reference * g.references;
    return check_memory(stats.planned_bytes, settings.memory_limit_bytes,
                        "building at depth " + std::to_string(g.depth) + " with " +
                            std::to_string(g.references) + " references");
  };

  clock.stage("scene_bound", 0.0, 0.1 * share, [&] {
    // A guess, from all vertices but the last mesh's strays. Whether triangles use the outermost
    // ones and none outside is seen with their boxes.
    if (mesh.triangle_count == 0 || !vertex_bounds(mesh, w.strays, settings.simd, g.bounds)) {
      failure = bounds_of_triangles(mesh, w, g.bounds);
    }
  });
  if (!failure.ok()) return failure;

  clock.stage("grid", 0.1 * share, 0.45 * share, [&] {
    const BoxPass pass = grid_triangles(mesh, settings, w, g);
    const bool guess_holds = pass.indices_ok && pass.inside && pass.touches == kTouchesAll;
    if (!guess_holds && mesh.triangle_count != 0) {
      failure = bounds_of_triangles(mesh, w, g.bounds);
      if (!failure.ok()) return;
      grid_triangles(mesh, settings, w, g);
    }
    failure = settle_depth(mesh.triangle_count, settings, w, g);
    if (!failure.ok()) return;
    // The records are not counted yet, but each triangle has one.
    grid = Grid(g.bounds, settings.axes, g.depth);
    bucket_grid = BucketGrid(CodeAxes(g.schedule, g.depth), g.box_depth - g.depth,
                             tbb::this_task_arena::max_concurrency());
    failure = plan(mesh.triangle_count);
  });
  if (!failure.ok()) return failure;

  clock.stage("morton_code", 0.45 * share, 0.7 * share, [&] {
    count_records(w.boxes, bucket_grid, settings.simd, w.buckets);
    failure = plan(w.buckets.record_begin.back());
    if (failure.ok()) place_records(w.boxes, bucket_grid, settings.simd, w.buckets);
  });
  if (!failure.ok()) return failure;
  // Sorting a bucket finds its leaves too: leaf_node has no pass of its own.
  clock.stage("radix_sort", 0.7 * share, share, [&] {
    ids.resize(g.references);
    sort_buckets(bucket_grid, settings.simd, w.buckets, ids);
  });
  if (clock.cancelled()) return clock.cancelled_status();
  sorted.references = g.references;
  return {};
}

Status morton_build(const MeshView& mesh, const BuildSettings& settings, Workspace& w,
                    TreeArrays& tree, BuildStats& stats) {
  StageClock clock(settings.progress, stats.stages);
  SortedLeaves sorted;
  if (Status status = sort_into_leaves(mesh, settings, 0, 0.9, clock, w, tree.ids, stats, sorted);
      !status.ok()) {
    return status;
  }
  clock.stage("internal_node", 0.9, 1.0, [&] {
    if (sorted.references == 0) {
      tree.nodes.assign(1, Node::leaf(0, 0));
    } else {
      emit_tree(sorted.buckets, w.buckets, sorted.grid, w.first_node_of_bucket, tree.nodes);
    }
  });
  if (clock.cancelled()) return clock.cancelled_status();

  tree.info = sorted.grid.tree_info(mesh.triangle_count);
  stats.triangles = mesh.triangle_count;
  stats.references = sorted.references;
  return {};
}

}  // namespace fasttree::build
