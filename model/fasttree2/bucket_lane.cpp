// SPDX-License-Identifier: Apache-2.0
// A lane's two halves and what they share. The back's work on ids and leaves is in lane_output.cpp.
#include "model/fasttree2/bucket_lane.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include "model/fasttree2/lane_reasons.h"

namespace fasttree::model::ft2 {

BucketLane::BucketLane(std::string name, Registers& registers, Dma& dma, ChunkPool& pool,
                       BucketOrder& order, WritePort& ids)
    : Unit(name, "radix_sort",
           {"records", "order of buckets", "memory", "node_emitter", "own back half"}),
      r_(registers),
      reader_(registers, dma, pool, name),
      order_(order),
      ids_(ids),
      leaves_(registers.config.leaf_queue),
      ring_size_(registers.config.lane_records),
      records_(registers.config.lane_records),
      placed_(registers.config.lane_references) {
  front_.counters.resize(registers.config.lane_cells);
  back_.counters.resize(registers.config.lane_cells);
  front_.used.resize(registers.config.lane_cells / kBlockCells);
  back_.used.resize(registers.config.lane_cells / kBlockCells);
}

bool BucketLane::can_accept() const {
  return !has_next_ && reader_.can_start() && front_state_ != Front::count;
}

void BucketLane::accept(const BucketTask& task, std::uint64_t ticket) {
  assert(can_accept());
  next_ = task;
  next_ticket_ = ticket;
  has_next_ = true;
  reader_.start(task.chain);
}

bool BucketLane::passes(const Bucket& bucket) const {
  return bucket.task.prefix_bits == r_.levels.depth();
}

bool BucketLane::take_index(Bucket& bucket) {
  if (bucket.index_taken) return true;
  if (order_.next_index != bucket.ticket) return false;
  if (order_.id_end < bucket.total) {
    r_.fail(name() + ": bucket " + std::to_string(bucket.task.prefix) + " has " +
            std::to_string(bucket.total) + " references, but only " +
            std::to_string(order_.id_end) + " are left");
    return false;
  }
  order_.id_end -= bucket.total;
  bucket.first = order_.id_end;
  ++order_.next_index;
  bucket.index_taken = true;
  return true;
}

// ---- Front: load and count, then sum.

bool BucketLane::begin_bucket() {
  // Records that are passed through come out of the same reader, in order.
  if (back_state_ == Back::pass && streamed_ < back_.total) {
    front_reason_ = kBack;
    return false;
  }
  front_.task = next_;
  front_.ticket = next_ticket_;
  has_next_ = false;
  front_.base = ring_next_;
  front_.loaded = 0;
  front_.total = 0;
  front_.index_taken = false;
  if (passes(front_)) {
    front_.total = next_.chain.count;
    front_state_ = Front::ready;
    return true;
  }
  front_.words = std::max(1u, (1u << (r_.levels.depth() - next_.prefix_bits)) / kBlockCells);
  front_state_ = Front::count;
  return true;
}

bool BucketLane::count() {
  if (!front_walk_.active()) {
    if (front_.loaded == front_.task.chain.count) {
      front_state_ = Front::prefix;
      front_word_ = front_.used.from(0);
      front_sum_ = 0;
      return sum_prefixes();
    }
    if (!reader_.valid()) {
      front_reason_ = kRecords;
      return false;
    }
    if (ring_used_ == ring_size_) {
      front_reason_ = kBack;
      return false;
    }
    const Record record = reader_.front();
    reader_.pop();
    records_[ring_next_] = record;
    ring_next_ = ring_next_ + 1 == ring_size_ ? 0 : ring_next_ + 1;
    ++ring_used_;
    ++front_.loaded;
    front_walk_.begin(r_.levels, record.box, front_.words);
    if (!front_walk_.active()) return true;
  }
  // One word is read, its marked counters go up by one, and it is written back.
  std::uint32_t* word = front_.counters.data() + front_walk_.word() * kBlockCells;
  for (std::uint32_t mask = front_walk_.mask(); mask != 0; mask &= mask - 1) {
    ++word[std::countr_zero(mask)];
  }
  front_.used.insert(front_walk_.word());
  front_.total += static_cast<std::uint32_t>(std::popcount(front_walk_.mask()));
  front_walk_.next();
  return true;
}

bool BucketLane::sum_prefixes() {
  if (front_word_ == WordSet::kNone) {
    r_.fail(name() + ": a bucket without references");  // only where the records were not ours
    return false;
  }
  std::uint32_t* word = front_.counters.data() + front_word_ * kBlockCells;
  for (std::uint32_t c = 0; c < kBlockCells; ++c) {
    word[c] = std::exchange(front_sum_, front_sum_ + word[c]);
  }
  front_word_ = front_.used.from(front_word_ + 1);
  if (front_word_ == WordSet::kNone) front_state_ = Front::ready;
  return true;
}

bool BucketLane::tick_front() {
  switch (front_state_) {
    case Front::idle:
      return has_next_ && begin_bucket();
    case Front::count:
      return count();
    case Front::prefix:
      return sum_prefixes();
    case Front::ready:
      front_reason_ = kBack;
      return false;
  }
  return false;
}

// ---- Back: place, and stream out.

void BucketLane::begin_back() {
  std::swap(front_, back_);
  front_state_ = Front::idle;
  current_ = 0;
  window_ = 0;
  streamed_ = 0;
  line_fill_ = 0;
  leaves_done_ = false;
  leaf_word_ = passes(back_) ? WordSet::kNone : back_.used.below(back_.words);
  leaf_cell_ = kBlockCells;
  back_state_ = passes(back_) ? Back::pass : Back::place;
}

void BucketLane::end_back() {
  back_state_ = Back::idle;
  ring_used_ -= back_.loaded;
  back_.loaded = 0;
}

bool BucketLane::place() {
  if (!back_walk_.active()) {
    if (current_ == back_.loaded) {
      back_state_ = Back::stream;
      return stream();
    }
    back_walk_.begin(r_.levels, records_[slot(back_, current_)].box, back_.words);
    if (!back_walk_.active()) {
      ++current_;
      return true;
    }
  }
  // The marked cells of a word, as many as go to different banks.
  const std::uint64_t window_end = window_ + placed_.size();
  std::uint32_t* word = back_.counters.data() + back_walk_.word() * kBlockCells;
  std::uint32_t banks = 0;
  for (; back_walk_.mask() != 0; back_walk_.drop_lowest()) {
    const auto c = static_cast<std::uint32_t>(std::countr_zero(back_walk_.mask()));
    const std::uint32_t at = word[c];
    const std::uint32_t bank = 1u << (at % r_.config.place_width);
    if (banks & bank) return true;
    banks |= bank;
    if (at >= window_ && at < window_end) placed_[at - window_] = slot(back_, current_);
    ++word[c];
  }
  back_walk_.next();
  if (!back_walk_.active()) ++current_;
  return true;
}

bool BucketLane::rewind() {
  // Counters hold the ends of cells; the end of one is the start of the next.
  std::uint32_t* word = back_.counters.data() + back_word_ * kBlockCells;
  for (std::uint32_t c = 0; c < kBlockCells; ++c) word[c] = std::exchange(back_end_, word[c]);
  back_word_ = back_.used.from(back_word_ + 1);
  if (back_word_ == WordSet::kNone) {
    back_state_ = Back::place;
    current_ = 0;
  }
  return true;
}

bool BucketLane::tick_back() {
  switch (back_state_) {
    case Back::idle:
      return false;
    case Back::place:
      return place();
    case Back::rewind:
      return rewind();
    case Back::stream:
      return stream();
    case Back::pass:
      return pass_through();
  }
  return false;
}

void BucketLane::tick() {
  if (done()) return idle();
  reader_.step();
  const bool back_worked = tick_back();
  const bool front_worked = tick_front();
  // A bucket takes its place among the ids as soon as its references are counted.
  if (back_state_ != Back::idle) take_index(back_);
  if (front_state_ == Front::prefix || front_state_ == Front::ready) {
    take_index(front_);
  }
  if (front_worked || back_worked) {
    busy();
  } else {
    stalled(back_state_ != Back::idle ? back_reason_ : front_reason_);
  }
  if (front_state_ == Front::ready && back_state_ == Back::idle) begin_back();
}

std::string BucketLane::waits_for() const {
  if (done()) return "";
  const bool back = back_state_ != Back::idle;
  const std::string bucket =
      "bucket " + std::to_string(back ? back_.task.prefix : front_.task.prefix);
  switch (back ? back_reason_ : front_reason_) {
    case kRecords:
      return "memory for a record of " + bucket;
    case kOrder:
      return "the buckets before " + bucket + " in order";
    case kMemory:
      return "room for ids of " + bucket + " in the write buffer";
    default:
      return "node_emitter to take a leaf of " + bucket;
  }
}

}  // namespace fasttree::model::ft2
