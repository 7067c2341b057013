// SPDX-License-Identifier: Apache-2.0
// Step 5 of 6, internal node generation (INGU). Docs: docs/internal_node.md.
#pragma once

#include <cstdint>
#include <vector>

#include "grid/grid.h"
#include "reference/leaf_node.h"

namespace fasttree::reference {

/// Internal nodes by rank: node j is the lowest common ancestor of leaves j and j + 1.
struct InternalNodes {
  std::vector<std::uint32_t> node_index;  ///< in the complete tree: prefix bits, 1, zeros
  std::vector<std::uint32_t> axis;
  std::vector<float> split;

  std::size_t size() const { return node_index.size(); }
};

/// Position of the highest bit in which two different codes differ, found as the hardware does, by
/// shifting right until nothing differs any more.
int highest_different_bit(std::uint32_t a, std::uint32_t b);

/// Node index of a leaf cell: its code, then 1.
inline std::uint32_t leaf_node_index(std::uint32_t code) {
  return code << 1 | 1u;
}

/// Node index of the lowest common ancestor of leaves a < b whose highest different bit is m.
inline std::uint32_t ancestor_node_index(std::uint32_t upper_code, int m) {
  return upper_code >> m << m << 1;
}

InternalNodes internal_node(const LeafTable& leaves, const Grid& grid);

}  // namespace fasttree::reference
