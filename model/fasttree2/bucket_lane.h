// SPDX-License-Identifier: Apache-2.0
// A lane: the counting sort of one bucket, all of it on chip. Records are expanded into cells twice,
// once to count and once to place; the counters are the leaf table.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/fasttree2/cell_levels.h"
#include "model/fasttree2/record_reader.h"
#include "model/fasttree2/registers.h"
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

  /// Holds nothing, or is at the end of a bucket and can prefetch the next.
  bool can_accept() const;
  bool free() const { return state_ == State::idle && !has_next_; }
  void accept(const BucketTask& task, std::uint64_t ticket);

  Queue<LeafEntry>& leaves() { return leaves_; }

  void tick() override;
  bool done() const override { return state_ == State::idle && !has_next_; }
  std::string waits_for() const override;

 private:
  enum class State : std::uint8_t { idle, count, prefix, place, rewind, stream, pass };

  /// Goes over a record's cells block by block.
  struct BlockWalk {
    BoxWalk boxes;
    std::uint32_t word = 0;
    std::uint8_t mask = 0;
  };
  void begin_bucket();
  void begin_record(const Record& record);
  void load_block();
  void next_block();

  bool count();
  bool sum_prefixes();
  bool place();
  bool rewind();
  bool stream();
  bool walk_leaves();
  bool pass_through();
  bool put_id(std::uint32_t id);
  bool take_index();

  Registers& r_;
  RecordReader reader_;
  BucketOrder& order_;
  WritePort& ids_;
  Queue<LeafEntry> leaves_;

  State state_ = State::idle;
  bool has_next_ = false;
  BucketTask task_, next_;
  std::uint64_t ticket_ = 0, next_ticket_ = 0;
  std::size_t reason_ = 0;

  // The memories of the lane.
  std::vector<Record> records_;
  std::vector<std::uint32_t> counters_;
  std::vector<std::uint16_t> placed_;  ///< references: which of the records

  std::uint32_t loaded_ = 0;
  std::uint32_t current_ = 0;  ///< record that is placed
  BlockWalk walk_;
  std::uint64_t total_ = 0;  ///< references of the bucket
  std::uint32_t words_ = 0;
  std::uint32_t word_ = 0;
  std::uint32_t carry_ = 0;
  std::uint64_t window_ = 0;  ///< first reference that is placed in this pass
  bool index_taken_ = false;
  std::uint64_t first_ = 0;  ///< of the bucket's ids

  std::uint64_t streamed_ = 0;
  std::uint64_t id_address_ = 0;
  std::uint32_t line_fill_ = 0;  ///< bytes
  std::array<std::uint8_t, kMaxBeatBytes> line_{};

  bool leaves_done_ = false;
  std::uint32_t leaf_cell_ = 0;  ///< one past the next cell to look at
};

}  // namespace fasttree::model::ft2
