// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/bucket_lane.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace fasttree::model::ft2 {

namespace {
enum Reason : std::size_t { kRecords, kOrder, kMemory, kNodes };
}  // namespace

BucketLane::BucketLane(std::string name, Registers& registers, Dma& dma, ChunkPool& pool,
                       BucketOrder& order, WritePort& ids)
    : Unit(name, "radix_sort", {"records", "order of buckets", "memory", "node_emitter"}),
      r_(registers),
      reader_(registers, dma, pool, name),
      order_(order),
      ids_(ids),
      leaves_(registers.config.leaf_queue),
      records_(registers.config.lane_records),
      counters_(registers.config.lane_cells),
      placed_(registers.config.lane_references) {}

bool BucketLane::can_accept() const {
  if (has_next_ || !reader_.can_start()) return false;
  return state_ == State::idle || state_ == State::place || state_ == State::stream;
}

void BucketLane::accept(const BucketTask& task, std::uint64_t ticket) {
  assert(can_accept());
  next_ = task;
  next_ticket_ = ticket;
  has_next_ = true;
  reader_.start(task.chain);
}

void BucketLane::begin_bucket() {
  task_ = next_;
  ticket_ = next_ticket_;
  has_next_ = false;
  loaded_ = 0;
  total_ = 0;
  window_ = 0;
  streamed_ = 0;
  index_taken_ = false;
  leaves_done_ = false;
  walk_ = BlockWalk();
  const int cell_bits = r_.levels.depth() - task_.prefix_bits;
  if (cell_bits == 0) {
    total_ = task_.chain.count;
    state_ = State::pass;
    return;
  }
  words_ = std::max(1u, (1u << cell_bits) / kBlockCells);
  leaf_cell_ = words_ * kBlockCells;
  state_ = State::count;
}

void BucketLane::begin_record(const Record& record) {
  walk_.boxes = BoxWalk(record.box, r_.levels.block_bits());
  if (walk_.boxes.active()) load_block();
}

void BucketLane::load_block() {
  const Cell& at = walk_.boxes.at();
  const auto& bits = r_.levels.block_bits();
  const std::uint32_t code =
      r_.levels.grid().morton_code({at[0] << bits[0], at[1] << bits[1], at[2] << bits[2]});
  // A word that a broken memory's record names may lie outside; wires would cut it off as well.
  walk_.word = code / kBlockCells % words_;
  const CellBox part = walk_.boxes.inside();
  walk_.mask = 0xff;
  for (std::size_t a = 0; a < 3; ++a) walk_.mask &= r_.levels.covered(a, part.lo[a], part.hi[a]);
}

void BucketLane::next_block() {
  walk_.boxes.advance();
  if (walk_.boxes.active()) load_block();
}

bool BucketLane::count() {
  if (!walk_.boxes.active()) {
    if (loaded_ == task_.chain.count) {
      state_ = State::prefix;
      word_ = 0;
      carry_ = 0;
      return sum_prefixes();
    }
    if (!reader_.valid()) {
      reason_ = kRecords;
      return false;
    }
    const Record record = reader_.front();
    reader_.pop();
    records_[loaded_++] = record;
    begin_record(record);
    if (!walk_.boxes.active()) return true;
  }
  // One word is read, its marked counters go up by one, and it is written back.
  std::uint32_t* word = counters_.data() + walk_.word * kBlockCells;
  for (std::uint32_t mask = walk_.mask; mask != 0; mask &= mask - 1) ++word[std::countr_zero(mask)];
  total_ += static_cast<std::uint32_t>(std::popcount(walk_.mask));
  next_block();
  return true;
}

bool BucketLane::sum_prefixes() {
  std::uint32_t* word = counters_.data() + word_ * kBlockCells;
  for (std::uint32_t c = 0; c < kBlockCells; ++c) {
    const std::uint32_t count = word[c];
    word[c] = carry_;
    carry_ += count;
  }
  if (++word_ == words_) {
    state_ = State::place;
    current_ = 0;
  }
  return true;
}

bool BucketLane::place() {
  const std::uint64_t window_end = window_ + placed_.size();
  if (!walk_.boxes.active()) {
    if (current_ == loaded_) {
      state_ = State::stream;
      return stream();
    }
    begin_record(records_[current_]);
    if (!walk_.boxes.active()) {
      ++current_;
      return true;
    }
  }
  // The marked cells of a word, as many as hit different banks.
  std::uint32_t* word = counters_.data() + walk_.word * kBlockCells;
  std::uint32_t banks = 0;
  while (walk_.mask != 0) {
    const auto c = static_cast<std::uint32_t>(std::countr_zero(walk_.mask));
    const std::uint32_t at = word[c];
    const std::uint32_t bank = 1u << (at % r_.config.place_width);
    if (banks & bank) return true;
    banks |= bank;
    if (at >= window_ && at < window_end) placed_[at - window_] = static_cast<std::uint16_t>(current_);
    ++word[c];
    walk_.mask &= static_cast<std::uint8_t>(walk_.mask - 1);
  }
  next_block();
  if (!walk_.boxes.active()) ++current_;
  return true;
}

bool BucketLane::rewind() {
  // Counters hold ends of cells; the end of a cell is the start of the next.
  std::uint32_t* word = counters_.data() + word_ * kBlockCells;
  for (std::uint32_t c = 0; c < kBlockCells; ++c) {
    const std::uint32_t end = word[c];
    word[c] = carry_;
    carry_ = end;
  }
  if (++word_ == words_) {
    state_ = State::place;
    current_ = 0;
  }
  return true;
}

bool BucketLane::take_index() {
  if (index_taken_) return true;
  if (order_.next_index != ticket_) {
    reason_ = kOrder;
    return false;
  }
  if (order_.id_end < total_) {
    r_.fail(name() + ": bucket " + std::to_string(task_.prefix) + " has " + std::to_string(total_) +
            " references, but only " + std::to_string(order_.id_end) + " are left");
    return false;
  }
  order_.id_end -= total_;
  first_ = order_.id_end;
  ++order_.next_index;
  index_taken_ = true;
  id_address_ = r_.layout.ids.value + 4 * first_;
  line_fill_ = 0;
  return true;
}

bool BucketLane::put_id(std::uint32_t id) {
  // Gathered up to the next boundary of an access.
  const std::uint64_t next = id_address_ + line_fill_ + 4;
  const bool full = next % ids_.beat_bytes() == 0 || streamed_ + 1 == total_;
  if (full && !ids_.ready(Address(id_address_), line_fill_ + 4)) {
    reason_ = kMemory;
    return false;
  }
  std::memcpy(line_.data() + line_fill_, &id, 4);
  line_fill_ += 4;
  ++streamed_;
  if (full) {
    ids_.write(Address(id_address_), line_.data(), line_fill_);
    id_address_ += line_fill_;
    line_fill_ = 0;
  }
  return true;
}

bool BucketLane::stream() {
  if (!take_index()) return false;
  const std::uint64_t end = std::min<std::uint64_t>(total_, window_ + placed_.size());
  bool worked = false;
  for (std::uint32_t i = 0; i < r_.config.stream_ids && streamed_ < end; ++i) {
    if (!put_id(records_[placed_[streamed_ - window_]].id)) break;
    worked = true;
  }
  if (streamed_ == end && end < total_) {
    window_ = end;
    word_ = 0;
    carry_ = 0;
    state_ = State::rewind;
    return true;
  }
  // The last references are placed, so the counters hold the leaves' ends.
  if (end == total_ && !leaves_done_) worked |= walk_leaves();
  if (streamed_ == total_ && leaves_done_) {
    state_ = State::idle;
    std::fill_n(counters_.begin(), words_ * kBlockCells, 0);  // behind the walk, word by word
    return true;
  }
  return worked;
}

bool BucketLane::walk_leaves() {
  if (order_.next_leaves != ticket_) {
    reason_ = kOrder;
    return false;
  }
  if (!leaves_.ready()) {
    reason_ = kNodes;
    return false;
  }
  // The next cell downwards that is not empty, within one word: a priority encoder of eight.
  const std::uint32_t stop = (leaf_cell_ - 1) / kBlockCells * kBlockCells;
  while (leaf_cell_ > stop) {
    const std::uint32_t cell = --leaf_cell_;
    const std::uint32_t begin = cell == 0 ? 0 : counters_[cell - 1];
    const std::uint32_t count = counters_[cell] - begin;
    if (count == 0) continue;
    const int cell_bits = r_.levels.depth() - task_.prefix_bits;
    leaves_done_ = begin == 0;  // nothing lies below it
    leaves_.push({task_.prefix << cell_bits | cell, static_cast<std::uint32_t>(first_ + begin),
                  count, leaves_done_});
    return true;
  }
  if (leaf_cell_ == 0) {
    // Only where the records were not ours.
    r_.fail(name() + ": a bucket without references");
    leaves_done_ = true;
  }
  return true;
}

bool BucketLane::pass_through() {
  if (!take_index()) return false;
  bool worked = false;
  if (streamed_ < total_) {
    if (reader_.valid()) {
      if (put_id(reader_.front().id)) {
        reader_.pop();
        worked = true;
      }
    } else {
      reason_ = kRecords;
    }
  }
  if (!leaves_done_) {
    if (order_.next_leaves != ticket_) {
      if (!worked) reason_ = kOrder;
    } else if (leaves_.ready()) {
      leaves_.push({task_.prefix, static_cast<std::uint32_t>(first_),
                    static_cast<std::uint32_t>(total_), true});
      leaves_done_ = true;
      worked = true;
    }
  }
  if (streamed_ == total_ && leaves_done_) {
    state_ = State::idle;
    return true;
  }
  return worked;
}

void BucketLane::tick() {
  if (reader_.empty() && state_ == State::idle && !has_next_) return idle();
  reader_.step();
  if (state_ == State::idle && has_next_) begin_bucket();
  // Whoever is due takes its place among the ids as soon as its references are counted.
  if (!index_taken_ && (state_ == State::prefix || state_ == State::place)) take_index();
  bool worked = false;
  switch (state_) {
    case State::idle:
      return idle();
    case State::count:
      worked = count();
      break;
    case State::prefix:
      worked = sum_prefixes();
      break;
    case State::place:
      worked = place();
      break;
    case State::rewind:
      worked = rewind();
      break;
    case State::stream:
      worked = stream();
      break;
    case State::pass:
      worked = pass_through();
      break;
  }
  worked ? busy() : stalled(reason_);
}

std::string BucketLane::waits_for() const {
  if (done()) return "";
  switch (reason_) {
    case kRecords:
      return "memory for record " + std::to_string(loaded_) + " of bucket " +
             std::to_string(task_.prefix);
    case kOrder:
      return "the bucket before bucket " + std::to_string(task_.prefix) + " in order";
    case kMemory:
      return "room for ids in the write buffer";
    default:
      return "node_emitter to take a leaf of bucket " + std::to_string(task_.prefix);
  }
}

}  // namespace fasttree::model::ft2
