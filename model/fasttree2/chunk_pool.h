// SPDX-License-Identifier: Apache-2.0
// Chunks of memory for buckets: a counter hands out new ones, and those that were read are used
// again. A short stack of free chunks is on chip; what does not fit is spilled to memory, eight at
// a time, so memory stays bounded by what is live.
#pragma once

#include <cstdint>
#include <vector>

#include "model/fasttree2/dma.h"
#include "model/fasttree2/registers.h"

namespace fasttree::model::ft2 {

class ChunkPool : public Unit {
 public:
  ChunkPool(Registers& registers, Dma& dma);

  /// Chunks 0 .. first-1 are in use from the start; all others are free.
  void begin(std::uint32_t first);

  bool can_allocate() const { return !free_.empty() || (spilled_lines_ == 0 && !refilling_); }
  std::uint32_t allocate();
  /// What is on its way back from memory has its room reserved.
  bool can_release() const { return free_.size() + refill_left_ < slots_; }
  void release(std::uint32_t chunk) { free_.push_back(chunk); }

  void tick() override;
  bool done() const override { return !refilling_; }
  std::string waits_for() const override;

  std::uint64_t most_chunks() const { return next_; }
  /// One was asked for when all were in use.
  bool exhausted() const { return exhausted_; }

 private:
  static constexpr std::uint32_t kSpillIds = 8;
  static constexpr std::uint32_t kSpillBytes = 4 * kSpillIds;

  Registers& r_;
  ReadPort& read_;
  WritePort& write_;
  std::size_t slots_;
  std::vector<std::uint32_t> free_;
  std::uint32_t next_ = 0;
  bool exhausted_ = false;
  std::uint64_t spilled_lines_ = 0;
  bool refilling_ = false;
  std::uint32_t refill_left_ = 0;  ///< ids still to come of the line that is read
};

}  // namespace fasttree::model::ft2
