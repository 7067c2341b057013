// SPDX-License-Identifier: Apache-2.0
// Goes over the buckets in descending order and hands those a lane can hold to the lanes. A larger
// one is partitioned once more by the next bits of its code, through memory, ahead of the lanes.
#pragma once

#include <cstdint>
#include <vector>

#include "model/fasttree2/bucket_lane.h"
#include "model/fasttree2/record_reader.h"
#include "model/fasttree2/registers.h"
#include "model/fasttree2/write_combiner.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"

namespace fasttree::model::ft2 {

class BucketWalker : public Unit {
 public:
  BucketWalker(Registers& registers, Dma& dma, ChunkPool& pool, const WriteCombiner& first,
               WriteCombiner& second, Queue<BucketRecord>& to_second, Queue<BucketTask>& ready);

  void begin();
  void tick() override;
  bool done() const override { return !active_; }
  std::string waits_for() const override;

  std::uint64_t partitions() const { return partitions_; }
  std::uint64_t partitioned_records() const { return partitioned_records_; }
  std::size_t most_stacked() const { return most_stacked_; }
  /// Entries the stack of waiting buckets needs at most: each partition below the first leaves all
  /// but one of its parts there.
  static std::size_t stack_bound(const FastTree2Config& config);
  double fraction() const;

 private:
  bool fits(const BucketTask& task) const;
  void begin_partition(const BucketTask& task);
  bool partition();
  bool hand_out();

  Registers& r_;
  ChunkPool& pool_;
  const WriteCombiner& first_;
  WriteCombiner& second_;
  Queue<BucketRecord>& to_second_;
  Queue<BucketTask>& ready_;
  RecordReader reader_;

  bool active_ = false;
  std::uint32_t next_root_ = 0;  ///< one past the next bucket of the first partition
  std::vector<BucketTask> stack_;
  std::size_t most_stacked_ = 0;
  std::uint64_t partitions_ = 0;
  std::uint64_t partitioned_records_ = 0;
  std::size_t reason_ = 0;

  bool partitioning_ = false;
  BucketTask task_;  ///< being partitioned
  int part_bits_ = 0;
  std::uint32_t left_ = 0;
  bool flushing_ = false;
  BoxWalk walk_;
  std::uint32_t id_ = 0;
};

}  // namespace fasttree::model::ft2
