// SPDX-License-Identifier: Apache-2.0
// A memory for tests: each access takes a latency, plus a jitter that lets later accesses overtake
// earlier ones, and only so many are under way.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "model/memory/memory.h"

namespace fasttree::model::test {

struct PipeSettings {
  std::uint32_t access_bytes = 32;
  std::uint64_t latency_ps = 40000;
  std::uint64_t jitter_ps = 0;
  std::size_t queue = 64;
  std::uint64_t stops_after = ~std::uint64_t{0};  ///< accesses; then nothing is completed any more
};

class PipeMemory : public Memory {
 public:
  explicit PipeMemory(const PipeSettings& settings) : settings_(settings) {
    traits_.name = "pipe";
    traits_.access_bytes = settings.access_bytes;
  }

  const MemoryTraits& traits() const override { return traits_; }
  bool ready(Address, bool) const override { return under_way_.size() < settings_.queue; }
  void accept(const MemoryRequest& request, Picoseconds now) override {
    random_ = random_ * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t jitter = settings_.jitter_ps ? (random_ >> 33) % settings_.jitter_ps : 0;
    (request.write ? statistics_.writes : statistics_.reads)++;
    (request.write ? statistics_.write_bytes : statistics_.read_bytes) += request.bytes;
    under_way_.push_back({now.value + settings_.latency_ps + jitter, accepted_++, request});
  }
  void advance(Picoseconds now) override { now_ = now; }
  bool take(MemoryCompletion& completion) override {
    const auto first = std::min_element(under_way_.begin(), under_way_.end(),
                                        [](const Access& a, const Access& b) {
                                          return a.at != b.at ? a.at < b.at : a.number < b.number;
                                        });
    if (first == under_way_.end() || first->at > now_.value || taken_ >= settings_.stops_after) {
      return false;
    }
    completion = {first->request.tag, first->request.write, Picoseconds(first->at)};
    under_way_.erase(first);
    ++taken_;
    return true;
  }
  bool idle() const override { return under_way_.empty(); }
  const MemoryStatistics& statistics() const override { return statistics_; }
  std::string waits_for() const override { return "its latency"; }

 private:
  struct Access {
    std::uint64_t at;
    std::uint64_t number;
    MemoryRequest request;
  };
  PipeSettings settings_;
  MemoryTraits traits_;
  MemoryStatistics statistics_;
  std::vector<Access> under_way_;
  std::uint64_t random_ = 1;
  std::uint64_t accepted_ = 0;
  std::uint64_t taken_ = 0;
  Picoseconds now_;
};

}  // namespace fasttree::model::test
