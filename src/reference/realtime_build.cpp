// SPDX-License-Identifier: Apache-2.0
#include "reference/realtime_build.h"

#include <algorithm>
#include <bit>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "grid/large_triangle.h"
#include "grid/realtime_rule.h"
#include "reference/layer.h"
#include "reference/leaf_node.h"
#include "reference/morton_code.h"
#include "reference/radix_sort.h"
#include "reference/scene_bound.h"
#include "support/stage_clock.h"

namespace fasttree::reference {
namespace {

// References of the top grid with their sort, and at most so many times as many in the tree, each
// with two nodes.
std::uint64_t planned_bytes(std::uint64_t references) {
  return references * (3 * 8 + kRealtimeRule.whole_growth * (2 * 4 + 2 * sizeof(Node)));
}

Layer top_layer(const MeshView& mesh, const Grid& grid, const LeafTable& leaves,
                const References& sorted) {
  Layer top;
  top.grid = grid;
  std::map<std::uint32_t, LargeTriangle> large;
  for (std::uint32_t id = 0; id < mesh.triangle_count; ++id) {
    const auto triangle = mesh.triangle(id);
    if (LargeTriangle::is_large(grid, triangle))
      large.emplace(id, LargeTriangle(grid, id, triangle));
  }
  for (std::size_t j = 0; j < leaves.size(); ++j) {
    LayerList list;
    for (std::uint32_t i = 0; i < leaves.count[j]; ++i) {
      const std::uint32_t id = sorted.ids[leaves.first[j] + i];
      const auto found = large.find(id);
      if (found == large.end() || found->second.overlaps(grid.cell_of(leaves.code[j]))) {
        list.ids.push_back(id);
      }
    }
    if (list.ids.empty()) continue;
    list.cell = grid.bounds();
    for (std::size_t a = 0; a < 3; ++a) {
      const std::uint32_t k = grid.coordinate_of(leaves.code[j], a);
      if (k > 0) list.cell.lo[a] = grid.plane(a, k);
      if (k + 1 < 1u << grid.bits()[a]) list.cell.hi[a] = grid.plane(a, k + 1);
    }
    list.budget = std::uint64_t{kRealtimeRule.whole_growth} * list.ids.size();
    list.levels_left = static_cast<int>(kMaxTreeDepth) - grid.depth();
    top.code.push_back(leaves.code[j]);
    top.children.push_back(std::move(list));
  }
  return top;
}

// Writes nodes in pre-order.
class Emitter {
 public:
  explicit Emitter(const MeshView& mesh) : mesh_(mesh) {}

  void emit(const Layer& layer) { emit(layer, 0, layer.children.size()); }

  std::vector<Node> nodes;
  std::vector<std::uint32_t> ids;

 private:
  void emit(const LayerList& list) {
    const Layer layer = make_layer(mesh_, list);
    if (!layer.children.empty()) {
      emit(layer);
      return;
    }
    nodes.push_back(Node::leaf(static_cast<std::uint32_t>(ids.size()),
                               static_cast<std::uint32_t>(list.ids.size())));
    ids.insert(ids.end(), list.ids.begin(), list.ids.end());
  }

  // The cells [first, end) of a layer: where there are several, the highest bit in which the first
  // and the last code differ says on which side of the node each is.
  void emit(const Layer& layer, std::size_t first, std::size_t end) {
    if (end - first == 1) {
      emit(layer.children[first]);
      return;
    }
    const int m = std::bit_width(layer.code[first] ^ layer.code[end - 1]) - 1;
    std::size_t upper = first;
    while ((layer.code[upper] >> m & 1) == 0) ++upper;
    const Grid::Split split = layer.grid.split_below(layer.code[upper], m);
    const std::size_t node = nodes.size();
    nodes.emplace_back();
    emit(layer, first, upper);
    nodes[node] = Node::inner(split.axis, split.position, static_cast<std::uint32_t>(nodes.size()));
    emit(layer, upper, end);
  }

  const MeshView& mesh_;
};

}  // namespace

Result<Tree> realtime_build(const MeshView& mesh, const BuildSettings& settings,
                            BuildStats& stats) {
  if (Status status = validate(mesh); !status.ok()) return status;
  StageClock clock(settings.progress, stats.stages);
  Status failure;
  Box3 bounds;
  Grid grid;
  std::uint64_t references = 0;
  clock.stage("scene_bound", 0.00, 0.05, [&] {
    Result<Box3> result = scene_bound(mesh);
    failure = result.status();
    if (result.ok()) bounds = result.value();
  });
  if (!failure.ok()) return failure;
  clock.stage("grid", 0.05, 0.10, [&] {
    const ReferenceCounts counts = count_references(mesh, bounds, AxisSchedule::longest);
    const Result<int> depth =
        choose_depth(counts, mesh.triangle_count, top_grid_settings(settings));
    failure = depth.status();
    if (!depth.ok()) return;
    references = counts.at[static_cast<std::size_t>(depth.value())];
    stats.planned_bytes = planned_bytes(references);
    if (settings.memory_limit_bytes != 0 && stats.planned_bytes > settings.memory_limit_bytes) {
      failure = {StatusCode::resource_limit,
                 "building from " + std::to_string(references) + " references may take " +
                     std::to_string(stats.planned_bytes) + " bytes, over the limit of " +
                     std::to_string(settings.memory_limit_bytes) +
                     ". Raise the limit or ask for a smaller depth."};
      return;
    }
    grid = Grid(bounds, AxisSchedule::longest, depth.value());
  });
  if (!failure.ok()) return failure;

  Layer top;
  clock.stage("radix_sort", 0.10, 0.30, [&] {
    const References sorted = radix_sort(morton_code(mesh, grid, references));
    top = top_layer(mesh, grid, leaf_node(sorted), sorted);
  });
  Emitter emitter(mesh);
  clock.stage("layers", 0.30, 1.00, [&] {
    if (top.children.empty()) {
      emitter.nodes.assign(1, Node::leaf(0, 0));
    } else {
      emitter.emit(top);
    }
  });
  if (clock.cancelled()) return clock.cancelled_status();
  stats.triangles = mesh.triangle_count;
  stats.references = emitter.ids.size();
  return Tree(realtime_tree_info(bounds, mesh.triangle_count), std::move(emitter.nodes),
              std::move(emitter.ids));
}

}  // namespace fasttree::reference
