// SPDX-License-Identifier: Apache-2.0
#include "model/report/stage_arrays.h"

#include <bit>
#include <utility>

#include "fasttree/device_image.h"
#include "model/report/first_difference.h"
#include "reference/reference_build.h"

namespace fasttree::model {
namespace {

using Words = std::vector<std::uint32_t>;

Words bound_words(const Box3& bounds) {
  Words words;
  for (const Vec3& corner : {bounds.lo, bounds.hi}) {
    for (std::size_t a = 0; a < 3; ++a) words.push_back(std::bit_cast<std::uint32_t>(corner[a]));
  }
  return words;
}

// Every n-th word, from the one at `first` on.
Words column(const Words& rows, std::size_t first, std::size_t n) {
  Words words;
  words.reserve(rows.size() / n);
  for (std::size_t i = first; i < rows.size(); i += n) words.push_back(rows[i]);
  return words;
}

void add_nodes(const Words& nodes, std::uint32_t root, const Words& marks,
               std::vector<StageArray>& list) {
  list.push_back({"internal_node", "split_planes", column(nodes, 2, 4)});
  list.push_back({"internal_node", "split_axes", column(nodes, 3, 4)});
  list.push_back({"bit_encoding", "mark_words", marks});
  list.push_back({"path_compression", "lower_children", column(nodes, 0, 4)});
  list.push_back({"path_compression", "upper_children", column(nodes, 1, 4)});
  list.push_back({"path_compression", "root", {root}});
}

}  // namespace

std::vector<StageArray> stage_arrays(const SimulationResult& result) {
  const IntermediateArrays& a = result.arrays;
  std::vector<StageArray> list{
      {"scene_bound", "bounds", bound_words(a.bounds)},
      {"morton_code", "unsorted_codes", a.unsorted_codes},
      {"morton_code", "unsorted_ids", a.unsorted_ids},
      {"radix_sort", "sorted_codes", a.sorted_codes},
      {"radix_sort", "sorted_ids", a.sorted_ids},
      {"leaf_node", "leaf_codes", a.leaf_codes},
      {"leaf_node", "leaf_first", a.leaf_first},
      {"leaf_node", "leaf_count", a.leaf_count},
  };
  add_nodes(a.node_words, a.root, a.mark_words, list);
  return list;
}

Result<std::vector<StageArray>> reference_stage_arrays(const MeshView& mesh,
                                                       const MachineConfig& config,
                                                       const ProgressCallback& progress) {
  BuildSettings settings = build_settings(config);
  settings.progress = progress;
  BuildStats stats;
  const Result<reference::ReferenceBuild> built = reference::build(mesh, settings, stats);
  if (!built.ok()) return built.status();
  const reference::ReferenceBuild& b = built.value();
  const DeviceImage image = reference::device_image(b);
  Words nodes;
  nodes.reserve(4 * image.internal.size());
  for (const DeviceInternalNode& node : image.internal) {
    nodes.insert(nodes.end(),
                 {node.lower, node.upper, std::bit_cast<std::uint32_t>(node.split), node.axis});
  }
  std::vector<StageArray> list{
      {"scene_bound", "bounds", bound_words(b.bounds)},
      {"morton_code", "unsorted_codes", b.references.codes},
      {"morton_code", "unsorted_ids", b.references.ids},
      {"radix_sort", "sorted_codes", b.sorted.codes},
      {"radix_sort", "sorted_ids", b.sorted.ids},
      {"leaf_node", "leaf_codes", b.leaves.code},
      {"leaf_node", "leaf_first", b.leaves.first},
      {"leaf_node", "leaf_count", b.leaves.count},
  };
  add_nodes(nodes, image.root, b.essential.words(), list);
  return list;
}

}  // namespace fasttree::model
