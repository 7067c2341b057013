// SPDX-License-Identifier: Apache-2.0
#include "reference/path_compression.h"

#include <bit>

namespace fasttree::reference {

Step climb(std::uint32_t node_index) {
  const int i = std::countr_zero(node_index);
  Step step;
  step.upper_child = node_index >> (i + 1) & 1u;
  step.parent = (node_index & ~(1u << i)) | 1u << (i + 1);
  return step;
}

Links path_compression(const LeafTable& leaves, const InternalNodes& nodes,
                       const EssentialBitmap& bitmap, int depth) {
  Links links;
  links.lower.resize(nodes.size());
  links.upper.resize(nodes.size());
  links.internal_parent.resize(nodes.size());
  links.leaf_parent.resize(leaves.size());
  const std::uint32_t root_index = 1u << depth;

  // Climbs from a node, writes `child` into the essential ancestor and returns that one's rank.
  const auto link = [&](std::uint32_t node_index, std::uint32_t child) {
    while (node_index != root_index) {
      const Step step = climb(node_index);
      ++links.climb_steps;
      if (bitmap.essential(step.parent)) {
        const std::uint32_t parent = bitmap.rank(step.parent);
        (step.upper_child ? links.upper : links.lower)[parent] = child;
        return parent;
      }
      node_index = step.parent;
    }
    links.root = child;  // no essential ancestor
    return kNoParent;
  };

  for (std::uint32_t j = 0; j < leaves.size(); ++j) {
    links.leaf_parent[j] = link(leaf_node_index(leaves.code[j]), j | kDeviceLeaf);
  }
  for (std::uint32_t j = 0; j < nodes.size(); ++j) {
    links.internal_parent[j] = link(nodes.node_index[j], j);
  }
  return links;
}

}  // namespace fasttree::reference
