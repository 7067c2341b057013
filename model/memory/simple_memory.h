// SPDX-License-Identifier: Apache-2.0
// Memories without banks: the ideal one (no time, no limit), and one of fixed latency with an
// optional limit of bandwidth. What a machine does beside them tells its own cycles apart.
#pragma once

#include "model/memory/completion_queue.h"
#include "model/memory/memory.h"
#include "model/memory/memory_config.h"

namespace fasttree::model {

/// Requests are carried out in the order of acceptance. Bandwidth counts whole accesses.
class SimpleMemory final : public Memory {
 public:
  /// `config.kind` is ideal or fixed.
  explicit SimpleMemory(const MemoryConfig& config);

  const MemoryTraits& traits() const override { return traits_; }
  bool ready(Address address, bool write) const override;
  void accept(const MemoryRequest& request, Picoseconds now) override;
  void advance(Picoseconds now) override;
  bool take(MemoryCompletion& completion) override;
  bool idle() const override { return completions_.empty(); }
  const MemoryStatistics& statistics() const override { return statistics_; }
  std::string waits_for() const override;

 private:
  MemoryTraits traits_;
  MemoryStatistics statistics_;
  CompletionQueue completions_;
  std::uint32_t queue_;  ///< requests under way; 0: no limit
  std::uint64_t latency_ps_;
  double access_ps_;  ///< of the bus, by one access
  double bus_free_ps_ = 0;
  std::uint32_t under_way_ = 0;
  Picoseconds now_;
};

}  // namespace fasttree::model
