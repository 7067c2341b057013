// SPDX-License-Identifier: Apache-2.0
#include "build/node_emission.h"

#include <array>
#include <bit>

namespace fasttree::build {

void emit_nodes(std::span<const std::uint32_t> leaf_codes,
                std::span<const std::uint32_t> leaf_first, std::uint32_t reference_count,
                const Grid& grid, std::span<Node> nodes) {
  // An internal node whose upper subtree is written and whose lower one is not.
  struct Open {
    int m;                     // highest different bit of the two leaves it lies between
    std::uint32_t upper_code;  // of the leaf above the split
    std::uint32_t upper;       // where its upper child lies
  };
  std::array<Open, kMaxDepth> open;
  std::size_t open_count = 0;
  auto next = static_cast<std::uint32_t>(nodes.size());
  std::uint32_t leaf_end = reference_count;

  const auto close = [&] {
    const Open& node = open[--open_count];
    const Grid::Split split = grid.split_below(node.upper_code, node.m);
    nodes[--next] = Node::inner(split.axis, split.position, node.upper);
  };
  for (std::size_t j = leaf_codes.size(); j-- > 0;) {
    nodes[--next] = Node::leaf(leaf_first[j], leaf_end - leaf_first[j]);
    leaf_end = leaf_first[j];
    if (j == 0) break;
    // The node between leaves j - 1 and j. Open nodes under it have both subtrees now.
    const int m = std::bit_width(leaf_codes[j - 1] ^ leaf_codes[j]) - 1;
    while (open_count > 0 && open[open_count - 1].m < m) close();
    open[open_count++] = {m, leaf_codes[j], next};
  }
  while (open_count > 0) close();
}

}  // namespace fasttree::build
