// SPDX-License-Identifier: Apache-2.0
// A partition in memory: records gather in a line for each bucket, full lines are written to the
// bucket's chunk, and full chunks are linked. The order of a bucket's records is that of arrival.
#pragma once

#include <cstdint>
#include <vector>

#include "model/fasttree2/chunk_pool.h"
#include "model/fasttree2/dma.h"
#include "model/fasttree2/morton_code.h"
#include "model/fasttree2/registers.h"
#include "model/kernel/queue.h"

namespace fasttree::model::ft2 {

/// Where a bucket's records begin, and how many there are.
struct BucketChain {
  std::uint32_t head = 0;
  std::uint32_t count = 0;
};

class WriteCombiner : public Unit {
 public:
  /// `static_heads`: bucket b begins in chunk b, else in one it asks for.
  WriteCombiner(std::string name, Registers& registers, Dma& dma, ChunkPool& pool,
                Queue<BucketRecord>& in, std::uint32_t most_buckets, bool static_heads);

  void begin(std::uint32_t buckets);
  /// No more records come after those in the queue: write out what is gathered.
  void finish() { finishing_ = true; }

  /// Forgets all records; those in the queue are dropped as well.
  void abandon() { active_ = false; }

  void tick() override;
  /// Flushed, and accepted by the memory.
  bool done() const override { return !active_ && port_.drained(); }
  std::string waits_for() const override;

  BucketChain chain(std::uint32_t bucket) const {
    return {entries_[bucket].head, entries_[bucket].count};
  }

 private:
  struct Entry {
    std::uint32_t head = 0;
    std::uint32_t chunk = 0;
    std::uint32_t next = 0;  ///< asked for when the first line is written
    std::uint32_t line = 0;
    std::uint32_t fill = 0;  ///< records in the line
    std::uint32_t count = 0;
  };
  std::uint8_t* line_of(std::uint32_t bucket) {
    return lines_.data() + std::size_t{bucket} * r_.config.combine_bytes;
  }
  Address address_of(const Entry& e) const;
  bool append();
  bool flush();

  Registers& r_;
  WritePort& port_;
  ChunkPool& pool_;
  Queue<BucketRecord>& in_;
  bool static_heads_;
  bool active_ = false;
  bool finishing_ = false;
  std::uint32_t buckets_ = 0;
  std::uint32_t flushed_ = 0;
  std::uint64_t links_ = 0;
  std::size_t reason_ = 0;
  std::vector<Entry> entries_;
  std::vector<std::uint8_t> lines_;
};

}  // namespace fasttree::model::ft2
