// SPDX-License-Identifier: Apache-2.0
#include "reference/internal_node.h"

namespace fasttree::reference {

int highest_different_bit(std::uint32_t a, std::uint32_t b) {
  int m = -1;
  for (std::uint32_t different = a ^ b; different != 0; different >>= 1) ++m;
  return m;
}

InternalNodes internal_node(const LeafTable& leaves, const Grid& grid) {
  InternalNodes nodes;
  const std::size_t count = leaves.size() > 0 ? leaves.size() - 1 : 0;
  nodes.node_index.resize(count);
  nodes.axis.resize(count);
  nodes.split.resize(count);
  for (std::size_t j = 0; j < count; ++j) {
    const std::uint32_t upper = leaves.code[j + 1];
    const int m = highest_different_bit(leaves.code[j], upper);
    const Grid::Split split = grid.split_below(upper, m);
    nodes.node_index[j] = ancestor_node_index(upper, m);
    nodes.axis[j] = split.axis;
    nodes.split[j] = split.position;
  }
  return nodes;
}

}  // namespace fasttree::reference
