// SPDX-License-Identifier: Apache-2.0
// The wire between two clocked units: a queue with valid and ready. What is pushed in a cycle can
// be seen in the next, and room made in a cycle can be used in the next, so that a machine behaves
// the same in whichever order its units are ticked.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace fasttree::model {

/// First in, first out, of fixed depth. One producer and one consumer unit. clock() ends the cycle.
template <typename T>
class Queue {
 public:
  /// A depth of 1 passes an element every other cycle; 2 is a register with a skid buffer.
  explicit Queue(std::size_t depth) : slots_(depth) { assert(depth > 0); }

  std::size_t depth() const { return slots_.size(); }

  /// Producer: room for one more (`count` more) in this cycle.
  bool ready(std::size_t count = 1) const { return held_ + pushed_ + count <= slots_.size(); }
  void push(T value) {
    assert(ready());
    slots_[wrap(head_ + popped_ + visible() + pushed_)] = std::move(value);
    ++pushed_;
  }

  /// Consumer: something to take in this cycle.
  bool valid() const { return visible() > 0; }
  std::size_t visible() const { return held_ - popped_; }
  const T& front() const { return peek(0); }
  const T& peek(std::size_t i) const {
    assert(i < visible());
    return slots_[wrap(head_ + popped_ + i)];
  }
  T pop() {
    assert(valid());
    T value = std::move(slots_[wrap(head_ + popped_)]);
    ++popped_;
    return value;
  }
  /// Takes the front where front() has been enough.
  void drop() {
    assert(valid());
    ++popped_;
  }

  /// The rising edge: pushes become visible, and popped slots free.
  void clock() {
    head_ = wrap(head_ + popped_);
    held_ += pushed_ - popped_;
    pushed_ = popped_ = 0;
  }

  /// Nothing in it, nor on its way in.
  bool empty() const { return visible() + pushed_ == 0; }

 private:
  std::size_t wrap(std::size_t i) const { return i >= slots_.size() ? i - slots_.size() : i; }

  std::vector<T> slots_;
  std::size_t head_ = 0;    ///< first slot held at the start of the cycle
  std::size_t held_ = 0;    ///< slots in use at the start of the cycle
  std::size_t pushed_ = 0;  ///< in this cycle
  std::size_t popped_ = 0;  ///< in this cycle
};

}  // namespace fasttree::model
