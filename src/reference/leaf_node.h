// SPDX-License-Identifier: Apache-2.0
// Step 4 of 6, leaf node generation (LNGU). Docs: docs/leaf_node.md.
#pragma once

#include <cstdint>
#include <vector>

#include "reference/morton_code.h"

namespace fasttree::reference {

/// The leaf table: runs of sorted references with equal codes, in ascending order of code.
struct LeafTable {
  std::vector<std::uint32_t> code;
  std::vector<std::uint32_t> first;  ///< base index into the sorted references
  std::vector<std::uint32_t> count;

  std::size_t size() const { return code.size(); }
};

/// Neighbours with different codes start a new leaf; a leaf's size is the difference of two
/// neighbouring base indices.
LeafTable leaf_node(const References& sorted);

}  // namespace fasttree::reference
