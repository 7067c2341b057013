// SPDX-License-Identifier: Apache-2.0
// A pipelined unit's registers: what goes in comes out a fixed number of cycles later, in order,
// and waits at the end until it is taken.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fasttree::model::ft2 {

template <typename T>
class Pipeline {
 public:
  explicit Pipeline(std::uint32_t latency) : latency_(latency), ring_(std::size_t{latency} + 2) {}

  /// A stage at the end that is not taken stops those behind it.
  bool ready() const { return held_ < ring_.size(); }
  void push(const T& value, std::uint64_t cycle) {
    assert(ready());
    ring_[wrap(head_ + held_++)] = {value, cycle + latency_};
  }
  bool valid(std::uint64_t cycle) const { return held_ > 0 && ring_[head_].due <= cycle; }
  const T& front() const { return ring_[head_].value; }
  void pop() {
    head_ = wrap(head_ + 1);
    --held_;
  }
  bool empty() const { return held_ == 0; }

 private:
  struct Entry {
    T value;
    std::uint64_t due = 0;
  };
  std::size_t wrap(std::size_t i) const { return i >= ring_.size() ? i - ring_.size() : i; }

  std::uint32_t latency_;
  std::vector<Entry> ring_;
  std::size_t head_ = 0;
  std::size_t held_ = 0;
};

}  // namespace fasttree::model::ft2
