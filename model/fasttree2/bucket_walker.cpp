// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/bucket_walker.h"

#include <algorithm>
#include <bit>

namespace fasttree::model::ft2 {

namespace {
enum Reason : std::size_t { kRecords, kCombiner, kLanes };
}  // namespace

BucketWalker::BucketWalker(Registers& registers, Dma& dma, ChunkPool& pool,
                           const WriteCombiner& first, WriteCombiner& second,
                           Queue<BucketRecord>& to_second, Queue<BucketTask>& ready)
    : Unit("bucket_walker", "radix_sort", {"records", "write_combiner2", "lanes"}),
      r_(registers),
      pool_(pool),
      first_(first),
      second_(second),
      to_second_(to_second),
      ready_(ready),
      reader_(registers, dma, pool, "bucket_walker") {
  stack_.reserve(stack_bound(registers.config));
}

std::size_t BucketWalker::stack_bound(const FastTree2Config& config) {
  // A partition by b bits leaves at most 2^b - 1 buckets waiting while one is gone into; all the
  // partitions above a bucket share the bits below the first. Few large ones leave the most.
  const int bits = kMaxDepth - (std::bit_width(config.buckets) - 1);
  const int most = std::bit_width(config.sub_buckets) - 1;
  return static_cast<std::size_t>(bits / most) * ((1u << most) - 1) + ((1u << bits % most) - 1) + 1;
}

void BucketWalker::begin() {
  active_ = true;
  next_root_ = 1u << r_.bucket_bits;
  stack_.clear();
  partitioning_ = false;
}

double BucketWalker::fraction() const {
  return 1.0 - static_cast<double>(next_root_) / static_cast<double>(1u << r_.bucket_bits);
}

bool BucketWalker::fits(const BucketTask& task) const {
  const int cell_bits = r_.levels.depth() - task.prefix_bits;
  if (cell_bits == 0) return true;  // one leaf, streamed through
  return task.chain.count <= r_.config.lane_records && 1u << cell_bits <= r_.config.lane_cells;
}

void BucketWalker::begin_partition(const BucketTask& task) {
  const int cell_bits = r_.levels.depth() - task.prefix_bits;
  const int lane_cell_bits = std::bit_width(r_.config.lane_cells) - 1;
  // As many parts as let their cells be counted, and halve the records until a lane holds them with
  // room to spare: parts of a surface are filled unevenly.
  int bits = std::max(1, cell_bits - lane_cell_bits);
  while ((task.chain.count >> bits) * 4 > r_.config.lane_records) ++bits;
  part_bits_ =
      std::min({bits, cell_bits, static_cast<int>(std::bit_width(r_.config.sub_buckets)) - 1});
  task_ = task;
  left_ = task.chain.count;
  partitioning_ = true;
  flushing_ = false;
  reader_.start(task.chain);
  second_.begin(1u << part_bits_);
  ++partitions_;
}

bool BucketWalker::partition() {
  if (flushing_) {
    // The parts may be read once the memory has accepted all of their bytes.
    if (!second_.done()) {
      reason_ = kCombiner;
      return false;
    }
    for (std::uint32_t part = 0; part < 1u << part_bits_; ++part) {
      const BucketChain chain = second_.chain(part);
      if (chain.count == 0) continue;
      stack_.push_back({task_.prefix << part_bits_ | part, task_.prefix_bits + part_bits_, chain});
    }
    most_stacked_ = std::max(most_stacked_, stack_.size());
    partitioning_ = false;
    return true;
  }
  const int prefix_bits = task_.prefix_bits + part_bits_;
  const auto& inside = r_.levels.bits_below(prefix_bits);
  if (!walk_.active()) {
    if (left_ == 0) {
      second_.finish();
      flushing_ = true;
      return true;
    }
    if (!reader_.valid()) {
      reason_ = kRecords;
      return false;
    }
    const Record record = reader_.front();
    reader_.pop();
    --left_;
    walk_ = BoxWalk(record.box, inside);
    id_ = record.id;
    if (!walk_.active()) return true;
  }
  if (!to_second_.ready()) {
    reason_ = kCombiner;
    return false;
  }
  const Cell& at = walk_.at();
  const std::uint32_t code =
      r_.levels.grid().morton_code({at[0] << inside[0], at[1] << inside[1], at[2] << inside[2]});
  const std::uint32_t part = code >> (r_.levels.depth() - prefix_bits) & ((1u << part_bits_) - 1);
  to_second_.push({part, {id_, walk_.inside()}});
  ++partitioned_records_;
  walk_.advance();
  return true;
}

bool BucketWalker::hand_out() {
  BucketTask task;
  if (!stack_.empty()) {
    task = stack_.back();
  } else {
    // A priority encoder over the bits that say which buckets hold anything.
    while (next_root_ > 0 && first_.chain(next_root_ - 1).count == 0) --next_root_;
    if (next_root_ == 0) {
      active_ = false;
      return false;
    }
    task = {next_root_ - 1, r_.bucket_bits, first_.chain(next_root_ - 1)};
  }
  const bool fit = fits(task);
  if (fit && !ready_.ready()) {
    reason_ = kLanes;
    return false;
  }
  if (!stack_.empty()) {
    stack_.pop_back();
  } else {
    --next_root_;
  }
  fit ? ready_.push(task) : begin_partition(task);
  return true;
}

void BucketWalker::tick() {
  if (!active_) return idle();
  reader_.step();
  const bool worked = partitioning_ ? partition() : hand_out();
  if (worked) return busy();
  active_ ? stalled(reason_) : idle();
}

std::string BucketWalker::waits_for() const {
  if (!active_) return "";
  switch (reason_) {
    case kRecords:
      return "memory for the records of bucket " + std::to_string(task_.prefix);
    case kCombiner:
      return "write_combiner2 for bucket " + std::to_string(task_.prefix);
    default:
      return "a lane to take a bucket";
  }
}

}  // namespace fasttree::model::ft2
