// SPDX-License-Identifier: Apache-2.0
#include "build/realtime_build.h"

#include "build/layers.h"
#include "grid/realtime_rule.h"

namespace fasttree::build {

Status realtime_build(const MeshView& mesh, const BuildSettings& settings, Workspace& w,
                      TreeArrays& tree, BuildStats& stats) {
  StageClock clock(settings.progress, stats.stages);
  SortedLeaves top;
  Status status = sort_into_leaves(mesh, top_grid_settings(settings), layer_bytes_per_reference(),
                                   0.4, clock, w, w.top_ids, stats, top);
  if (!status.ok()) return status;
  clock.stage("layers", 0.4, 0.9, [&] {
    find_large(mesh, top.grid, w.boxes, top.buckets.box_shift(), w.layers);
    build_layers(mesh, top.grid, w.buckets, w.top_ids, settings.simd, w.layers);
  });
  clock.stage("internal_node", 0.9, 1.0, [&] {
    if (top.references == 0) {
      tree.nodes.assign(1, Node::leaf(0, 0));
      tree.ids.clear();
    } else {
      status = assemble(top.grid, w.layers, tree.nodes, tree.ids);
    }
  });
  if (!status.ok()) return status;
  if (clock.cancelled()) return clock.cancelled_status();

  tree.info = realtime_tree_info(top.grid.bounds(), mesh.triangle_count);
  stats.triangles = mesh.triangle_count;
  stats.references = tree.ids.size();
  return {};
}

}  // namespace fasttree::build
