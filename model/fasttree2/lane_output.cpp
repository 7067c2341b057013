// SPDX-License-Identifier: Apache-2.0
// What leaves a lane: ids, several a cycle, and leaves, one a cycle, in descending order.
#include <algorithm>
#include <cstring>

#include "model/fasttree2/bucket_lane.h"
#include "model/fasttree2/lane_reasons.h"

namespace fasttree::model::ft2 {

bool BucketLane::put_id(std::uint32_t id) {
  if (line_fill_ == 0) id_address_ = r_.layout.ids.value + 4 * (back_.first + streamed_);
  // Gathered up to the next boundary of an access.
  const std::uint64_t next = id_address_ + line_fill_ + 4;
  const bool full = next % ids_.beat_bytes() == 0 || streamed_ + 1 == back_.total;
  if (full && !ids_.ready(Address(id_address_), line_fill_ + 4)) {
    back_reason_ = kMemory;
    return false;
  }
  std::memcpy(line_.data() + line_fill_, &id, 4);
  line_fill_ += 4;
  ++streamed_;
  if (full) {
    ids_.write(Address(id_address_), line_.data(), line_fill_);
    line_fill_ = 0;
  }
  return true;
}

bool BucketLane::stream() {
  if (!take_index(back_)) {
    back_reason_ = kOrder;
    return false;
  }
  const std::uint64_t end = std::min<std::uint64_t>(back_.total, window_ + placed_.size());
  bool worked = false;
  // Neighbouring references name records anywhere: the ids lie in twice as many banks as are read
  // in a cycle, and reading stops at the first conflict.
  const std::uint32_t banks = 2 * r_.config.stream_ids;
  std::uint32_t used = 0;
  for (std::uint32_t i = 0; i < r_.config.stream_ids && streamed_ < end; ++i) {
    const std::uint32_t record = placed_[streamed_ - window_];
    const std::uint32_t bank = 1u << (record % banks);
    if ((used & bank) || !put_id(records_[record].id)) break;
    used |= bank;
    worked = true;
  }
  if (streamed_ == end && end < back_.total) {
    window_ = end;
    back_word_ = back_.used.from(0);
    back_end_ = 0;
    back_state_ = Back::rewind;
    return true;
  }
  // The last references are placed, so the counters hold the leaves' ends.
  if (end == back_.total && !leaves_done_) worked |= walk_leaves();
  if (streamed_ == back_.total && leaves_done_) {
    end_back();
    return true;
  }
  return worked;
}

bool BucketLane::walk_leaves() {
  if (order_.next_leaves != back_.ticket) {
    if (streamed_ == back_.total) back_reason_ = kOrder;
    return false;
  }
  if (!leaves_.ready()) {
    if (streamed_ == back_.total) back_reason_ = kNodes;
    return false;
  }
  // The next cell downwards that is not empty: a priority encoder of eight, for every word in use
  // has one. Cells end where the next ones begin; the word below is read beside this one.
  const std::uint32_t below = back_.used.below(leaf_word_);
  std::uint32_t* word = back_.counters.data() + leaf_word_ * kBlockCells;
  const std::uint32_t start =
      below == WordSet::kNone ? 0 : back_.counters[below * kBlockCells + kBlockCells - 1];
  const auto begin_of = [&](std::uint32_t c) { return c == 0 ? start : word[c - 1]; };
  std::uint32_t cell = leaf_cell_ - 1;
  while (cell > 0 && word[cell] == begin_of(cell)) --cell;
  const std::uint32_t begin = begin_of(cell);
  leaves_done_ = begin == 0;  // nothing lies below it
  const int cell_bits = r_.levels.depth() - back_.task.prefix_bits;
  leaves_.push({back_.task.prefix << cell_bits | (leaf_word_ * kBlockCells + cell),
                static_cast<std::uint32_t>(back_.first + begin), word[cell] - begin, leaves_done_});
  leaf_cell_ = cell;
  if (begin == start) {
    // The word is done with, and is cleared for the next bucket.
    std::fill_n(word, kBlockCells, 0);
    back_.used.erase(leaf_word_);
    leaf_word_ = below;
    leaf_cell_ = kBlockCells;
  }
  return true;
}

bool BucketLane::pass_through() {
  if (!take_index(back_)) {
    back_reason_ = kOrder;
    return false;
  }
  bool worked = false;
  if (streamed_ < back_.total) {
    back_reason_ = kRecords;
    if (reader_.valid() && put_id(reader_.front().id)) {
      reader_.pop();
      worked = true;
    }
  }
  if (!leaves_done_) {
    if (order_.next_leaves != back_.ticket) {
      if (streamed_ == back_.total) back_reason_ = kOrder;
    } else if (leaves_.ready()) {
      leaves_.push({back_.task.prefix, static_cast<std::uint32_t>(back_.first),
                    static_cast<std::uint32_t>(back_.total), true});
      leaves_done_ = true;
      worked = true;
    } else if (streamed_ == back_.total) {
      back_reason_ = kNodes;
    }
  }
  if (streamed_ == back_.total && leaves_done_) {
    end_back();
    return true;
  }
  return worked;
}

}  // namespace fasttree::model::ft2
