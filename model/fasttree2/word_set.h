// SPDX-License-Identifier: Apache-2.0
// Which words of a lane's counters are in use: a bit each, and the next one up or down. Surfaces
// leave most cells of a bucket empty; what is not counted needs no prefix and no clearing.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace fasttree::model::ft2 {

class WordSet {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  void resize(std::uint32_t words) { bits_.assign((words + 63) / 64, 0); }
  void insert(std::uint32_t word) { bits_[word / 64] |= std::uint64_t{1} << (word % 64); }
  void erase(std::uint32_t word) { bits_[word / 64] &= ~(std::uint64_t{1} << (word % 64)); }

  /// The first member that is not below `word`.
  std::uint32_t from(std::uint32_t word) const {
    std::size_t i = word / 64;
    if (i >= bits_.size()) return kNone;
    std::uint64_t part = bits_[i] >> (word % 64) << (word % 64);
    while (part == 0) {
      if (++i == bits_.size()) return kNone;
      part = bits_[i];
    }
    return static_cast<std::uint32_t>(i * 64) + static_cast<std::uint32_t>(std::countr_zero(part));
  }
  /// The last member below `word`.
  std::uint32_t below(std::uint32_t word) const {
    std::size_t i = word / 64;
    std::uint64_t part = word % 64 == 0 ? 0 : bits_[i] & ((std::uint64_t{1} << (word % 64)) - 1);
    while (part == 0) {
      if (i == 0) return kNone;
      part = bits_[--i];
    }
    return static_cast<std::uint32_t>(i * 64 + 63) -
           static_cast<std::uint32_t>(std::countl_zero(part));
  }

 private:
  std::vector<std::uint64_t> bits_;
};

}  // namespace fasttree::model::ft2
