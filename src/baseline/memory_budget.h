// SPDX-License-Identifier: Apache-2.0
// Counts the bytes of a builder's arrays against the caller's limit, before they are allocated.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fasttree/status.h"

namespace fasttree::baseline {

class MemoryBudget {
 public:
  /// `limit` 0: count, but never refuse. `stage` is static and names the builder in messages.
  MemoryBudget(const char* stage, std::uint64_t limit) : stage_(stage), limit_(limit) {}

  /// Makes sure that `array` can hold `size` elements. While the array moves, the old and the new
  /// memory exist side by side, and both are counted.
  template <typename T>
  Status reserve(std::vector<T>& array, std::size_t size) {
    const std::size_t old_capacity = array.capacity();
    if (size <= old_capacity) return {};
    // Half as much again keeps the moves rare; only the bare size where that is all there is room
    // for.
    std::size_t capacity = std::max(size, old_capacity + old_capacity / 2);
    if (!fits<T>(capacity)) capacity = size;
    if (!fits<T>(capacity)) return refusal<T>(capacity);
    array.reserve(capacity);
    used_ += std::uint64_t{array.capacity() - old_capacity} * sizeof(T);
    return {};
  }

  std::uint64_t used() const { return used_; }

 private:
  template <typename T>
  bool fits(std::size_t capacity) const {
    return limit_ == 0 || (used_ <= limit_ && capacity <= (limit_ - used_) / sizeof(T));
  }

  template <typename T>
  Status refusal(std::size_t capacity) const {
    return {StatusCode::resource_limit,
            std::string(stage_) + ": " + std::to_string(used_) + " bytes held and " +
                std::to_string(std::uint64_t{capacity} * sizeof(T)) +
                " more needed are over the memory limit of " + std::to_string(limit_) +
                " bytes; raise the limit or choose profile paper"};
  }

  const char* stage_;
  std::uint64_t limit_;
  std::uint64_t used_ = 0;
};

}  // namespace fasttree::baseline
