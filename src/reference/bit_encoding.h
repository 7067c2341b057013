// SPDX-License-Identifier: Apache-2.0
// Step 5 of 6, the other half: bit encoding (BEU). Docs: docs/bit_encoding.md.
#pragma once

#include <cstdint>
#include <vector>

#include "reference/internal_node.h"

namespace fasttree::reference {

/// Which nodes of the complete tree are essential: one bit a node index, 32 to a word.
class EssentialBitmap {
 public:
  EssentialBitmap() = default;
  explicit EssentialBitmap(int depth);

  void mark(std::uint32_t node_index) { words_[node_index / 32] |= 1u << node_index % 32; }
  bool essential(std::uint32_t node_index) const {
    return words_[node_index / 32] >> node_index % 32 & 1u;
  }

  /// Counts the marks before each word, for rank(). To be called after the last mark.
  void count_marks();

  /// How many essential nodes come before this one in order: the address of an essential node.
  std::uint32_t rank(std::uint32_t node_index) const;

  const std::vector<std::uint32_t>& words() const { return words_; }

 private:
  std::vector<std::uint32_t> words_;
  std::vector<std::uint32_t> marks_before_;
};

EssentialBitmap bit_encoding(const InternalNodes& nodes, int depth);

}  // namespace fasttree::reference
