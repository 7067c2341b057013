// SPDX-License-Identifier: Apache-2.0
// Completions that wait to be taken, in order of time. Grows only where the caller leaves them.
#pragma once

#include <cstddef>
#include <vector>

#include "model/memory/memory.h"

namespace fasttree::model {

/// First in, first out; pushed in order of `at`.
class CompletionQueue {
 public:
  CompletionQueue() : ring_(64) {}

  bool empty() const { return count_ == 0; }
  const MemoryCompletion& front() const { return ring_[head_]; }
  void push(const MemoryCompletion& completion) {
    if (count_ == ring_.size()) grow();
    ring_[(head_ + count_) & (ring_.size() - 1)] = completion;
    ++count_;
  }
  MemoryCompletion pop() {
    const MemoryCompletion completion = ring_[head_];
    head_ = (head_ + 1) & (ring_.size() - 1);
    --count_;
    return completion;
  }

 private:
  void grow() {
    std::vector<MemoryCompletion> larger(ring_.size() * 2);
    for (std::size_t i = 0; i < count_; ++i) larger[i] = ring_[(head_ + i) & (ring_.size() - 1)];
    ring_ = std::move(larger);
    head_ = 0;
  }

  std::vector<MemoryCompletion> ring_;
  std::size_t head_ = 0;
  std::size_t count_ = 0;
};

}  // namespace fasttree::model
