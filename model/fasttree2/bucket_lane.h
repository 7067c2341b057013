// SPDX-License-Identifier: Apache-2.0
// A lane: the counting sort of one bucket after the other, all of it on chip. Records are expanded
// into cells twice, once to count and once to place; the counters are the leaf table. The front of
// a lane loads, counts and sums the next bucket while its back places and streams out the last.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/fasttree2/block_walk.h"
#include "model/fasttree2/record_reader.h"
#include "model/fasttree2/registers.h"
#include "model/fasttree2/word_set.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"

namespace fasttree::model::ft2 {

/// A bucket that a lane can take: a prefix of the Morton code, and its records.
struct BucketTask {
  std::uint32_t prefix = 0;
  int prefix_bits = 0;
  BucketChain chain;
};

/// A leaf on its way to the node emitter; leaves come in descending order.
struct LeafEntry {
  std::uint32_t code = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  bool last_of_bucket = false;
};

/// The order in which buckets, and so ids and nodes, follow each other. Buckets come in descending
/// order, so each one's ids end where those of the bucket before it begin.
struct BucketOrder {
  std::uint64_t next_ticket = 0;  ///< for the next bucket that is handed to a lane
  std::uint64_t next_index = 0;   ///< ticket of the bucket that may take its place among the ids
  std::uint64_t id_end = 0;       ///< where that one's ids end
  std::uint64_t next_leaves = 0;  ///< ticket of the bucket whose leaves are due
};

class BucketLane : public Unit {
 public:
  BucketLane(std::string name, Registers& registers, Dma& dma, ChunkPool& pool, BucketOrder& order,
             WritePort& ids);

  /// Its front is empty, or done with loading, so that the next bucket can be prefetched.
  bool can_accept() const;
  bool free() const { return front_state_ == Front::idle && !has_next_; }
  void accept(const BucketTask& task, std::uint64_t ticket);

  Queue<LeafEntry>& leaves() { return leaves_; }

  void tick() override;
  bool done() const override { return free() && back_state_ == Back::idle; }
  std::string waits_for() const override;

 private:
  enum class Front : std::uint8_t { idle, count, prefix, ready };
  enum class Back : std::uint8_t { idle, place, rewind, stream, pass };

  /// A bucket, with one of the two sets of counters.
  struct Bucket {
    BucketTask task;
    std::uint64_t ticket = 0;
    std::uint32_t base = 0;    ///< of its records in their ring
    std::uint32_t loaded = 0;  ///< records in the ring
    std::uint64_t total = 0;   ///< references
    std::uint32_t words = 0;   ///< of counters, eight each
    bool index_taken = false;
    std::uint64_t first = 0;  ///< of its ids
    std::vector<std::uint32_t> counters;
    WordSet used;  ///< words with a counter that is not zero
  };

  std::uint32_t slot(const Bucket& bucket, std::uint32_t record) const {
    const std::uint32_t at = bucket.base + record;
    return at >= ring_size_ ? at - ring_size_ : at;
  }
  bool passes(const Bucket& bucket) const;
  bool take_index(Bucket& bucket);

  bool tick_front();
  bool begin_bucket();
  bool count();
  bool sum_prefixes();

  bool tick_back();
  void begin_back();
  void end_back();
  bool place();
  bool rewind();
  bool stream();
  bool walk_leaves();
  bool pass_through();
  bool put_id(std::uint32_t id);

  Registers& r_;
  RecordReader reader_;
  BucketOrder& order_;
  WritePort& ids_;
  Queue<LeafEntry> leaves_;

  // The memories of the lane.
  std::uint32_t ring_size_;
  std::vector<Record> records_;        ///< ring of both buckets' records
  std::vector<std::uint32_t> placed_;  ///< references: which of the records
  std::uint32_t ring_next_ = 0;
  std::uint32_t ring_used_ = 0;

  bool has_next_ = false;
  BucketTask next_;
  std::uint64_t next_ticket_ = 0;

  Front front_state_ = Front::idle;
  std::size_t front_reason_ = 0;
  Bucket front_;
  BlockWalk front_walk_;
  std::uint32_t front_word_ = 0;
  std::uint32_t front_sum_ = 0;

  Back back_state_ = Back::idle;
  std::size_t back_reason_ = 0;
  Bucket back_;
  BlockWalk back_walk_;
  std::uint32_t current_ = 0;  ///< record that is placed
  std::uint64_t window_ = 0;   ///< first reference that is placed in this pass
  std::uint32_t back_word_ = 0;
  std::uint32_t back_end_ = 0;
  std::uint64_t streamed_ = 0;
  std::uint64_t id_address_ = 0;
  std::uint32_t line_fill_ = 0;  ///< bytes
  std::array<std::uint8_t, kMaxBeatBytes> line_{};
  bool leaves_done_ = false;
  std::uint32_t leaf_word_ = WordSet::kNone;  ///< that is gone over
  std::uint32_t leaf_cell_ = 0;               ///< in it, one past the next cell to look at
};

}  // namespace fasttree::model::ft2
