// SPDX-License-Identifier: Apache-2.0
// The data side of a bus port: a queue of bytes, clocked as Queue is.
#pragma once

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace fasttree::model {

/// First in, first out. The bus pushes beats, the unit behind the port takes what it needs.
class ByteFifo {
 public:
  explicit ByteFifo(std::size_t capacity)
      : capacity_(capacity), bytes_(std::bit_ceil(capacity)), mask_(bytes_.size() - 1) {}

  std::size_t capacity() const { return capacity_; }

  bool ready(std::size_t count) const { return held_ + pushed_ + count <= capacity_; }
  void push(const std::uint8_t* from, std::size_t count) {
    assert(ready(count));
    const std::size_t at = (head_ + held_ + pushed_) & mask_;
    const std::size_t first = std::min(count, bytes_.size() - at);
    std::memcpy(bytes_.data() + at, from, first);
    std::memcpy(bytes_.data(), from + first, count - first);
    pushed_ += count;
  }

  std::size_t visible() const { return held_ - popped_; }
  void pop(void* to, std::size_t count) {
    assert(count <= visible());
    const std::size_t at = (head_ + popped_) & mask_;
    const std::size_t first = std::min(count, bytes_.size() - at);
    std::memcpy(to, bytes_.data() + at, first);
    std::memcpy(static_cast<std::uint8_t*>(to) + first, bytes_.data(), count - first);
    popped_ += count;
  }
  /// Bytes popped in all cycles before this one.
  std::uint64_t taken() const { return taken_; }

  void clock() {
    head_ = (head_ + popped_) & mask_;
    held_ += pushed_ - popped_;
    taken_ += popped_;
    pushed_ = popped_ = 0;
  }
  bool empty() const { return visible() + pushed_ == 0; }

 private:
  std::size_t capacity_;
  std::vector<std::uint8_t> bytes_;
  std::size_t mask_;
  std::size_t head_ = 0;
  std::size_t held_ = 0;
  std::size_t pushed_ = 0;
  std::size_t popped_ = 0;
  std::uint64_t taken_ = 0;
};

}  // namespace fasttree::model
