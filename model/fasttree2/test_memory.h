// SPDX-License-Identifier: Apache-2.0
// A memory for tests: fixed latency, so many accesses a cycle and channel, one that never answers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <string>

#include "model/memory/memory.h"

namespace fasttree::model::ft2 {

class TestMemory : public Memory {
 public:
  struct Shape {
    std::uint32_t access_bytes = 32;
    std::uint64_t latency_ps = 60'000;
    std::uint64_t gap_ps = 1250;    ///< between two accesses
    std::size_t queue = 64;         ///< accesses under way
    std::uint64_t answers = ~0ull;  ///< after so many it is silent
  };
  explicit TestMemory(const Shape& shape) : shape_(shape) {
    traits_ = {"test", 2, shape.access_bytes, 0, 0};
  }

  const MemoryTraits& traits() const override { return traits_; }
  bool ready(Address, bool) const override { return pending_.size() < shape_.queue; }
  void accept(const MemoryRequest& r, Picoseconds now) override {
    EXPECT_LE(r.address.value % shape_.access_bytes + r.bytes, shape_.access_bytes);
    EXPECT_GT(r.bytes, 0u);
    const std::uint64_t start = std::max(free_at_, now.value);
    free_at_ = start + shape_.gap_ps;
    pending_.push_back({r.tag, r.write, Picoseconds(start + shape_.latency_ps)});
    (r.write ? statistics_.write_bytes : statistics_.read_bytes) += r.bytes;
  }
  void advance(Picoseconds now) override { now_ = now; }
  bool take(MemoryCompletion& completion) override {
    if (pending_.empty() || pending_.front().at > now_ || answered_ >= shape_.answers) return false;
    completion = pending_.front();
    pending_.pop_front();
    ++answered_;
    return true;
  }
  bool idle() const override { return pending_.empty(); }
  const MemoryStatistics& statistics() const override { return statistics_; }
  std::string waits_for() const override { return "itself"; }

 private:
  Shape shape_;
  MemoryTraits traits_;
  MemoryStatistics statistics_;
  std::deque<MemoryCompletion> pending_;
  Picoseconds now_;
  std::uint64_t free_at_ = 0;
  std::uint64_t answered_ = 0;
};

}  // namespace fasttree::model::ft2
