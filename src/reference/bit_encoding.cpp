// SPDX-License-Identifier: Apache-2.0
#include "reference/bit_encoding.h"

#include <bit>

#include "reference/prefix_sum.h"

namespace fasttree::reference {

EssentialBitmap::EssentialBitmap(int depth)
    : words_(((std::size_t{1} << (depth + 1)) + 31) / 32, 0) {}

void EssentialBitmap::count_marks() {
  marks_before_.resize(words_.size());
  for (std::size_t w = 0; w < words_.size(); ++w) {
    marks_before_[w] = static_cast<std::uint32_t>(std::popcount(words_[w]));
  }
  prefix_sum(marks_before_);
}

std::uint32_t EssentialBitmap::rank(std::uint32_t node_index) const {
  const std::uint32_t before = words_[node_index / 32] & ((1u << node_index % 32) - 1);
  return marks_before_[node_index / 32] + static_cast<std::uint32_t>(std::popcount(before));
}

EssentialBitmap bit_encoding(const InternalNodes& nodes, int depth) {
  EssentialBitmap bitmap(depth);
  for (const std::uint32_t node_index : nodes.node_index) bitmap.mark(node_index);
  bitmap.count_marks();
  return bitmap;
}

}  // namespace fasttree::reference
