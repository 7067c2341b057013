// SPDX-License-Identifier: Apache-2.0
// Reads a bucket's records back from its linked chunks, ahead of their use, in order. Part of the
// unit that uses the records, which calls step() once a cycle.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "model/fasttree2/chunk_pool.h"
#include "model/fasttree2/dma.h"
#include "model/fasttree2/registers.h"
#include "model/fasttree2/write_combiner.h"
#include "model/kernel/queue.h"

namespace fasttree::model::ft2 {

class RecordReader {
 public:
  RecordReader(Registers& registers, Dma& dma, ChunkPool& pool, const std::string& user);

  /// Room for another bucket. Its records follow those of the buckets before.
  bool can_start() const { return tasks_held_ < tasks_.size(); }
  void start(const BucketChain& chain);

  void step();

  bool valid() const { return line_.next < line_.records; }
  Record front() const;
  void pop();
  bool empty() const { return tasks_held_ == 0; }

 private:
  struct Line {
    std::array<std::uint8_t, kMaxBeatBytes * 4> bytes{};
    std::uint32_t offset = 0;  ///< of the first record
    std::uint32_t held = 0;    ///< bytes
    std::uint32_t wanted = 0;  ///< bytes, 0: no line is being gathered
    std::uint32_t records = 0;
    std::uint32_t next = 0;  ///< record to hand out
  };
  void request();
  void gather();

  Registers& r_;
  ReadPort& port_;
  ChunkPool& pool_;

  // Buckets asked for; the first is the one whose records come, the requests may be one ahead.
  std::array<BucketChain, 2> tasks_{};
  std::size_t tasks_head_ = 0;
  std::size_t tasks_held_ = 0;
  std::size_t requesting_ = 0;  ///< tasks whose requests are all made, of those held
  std::size_t gathered_ = 0;    ///< tasks whose data has all come, of those held

  // Side of the requests.
  bool request_open_ = false;
  std::uint32_t request_left_ = 0;  ///< records
  std::uint32_t request_chunk_ = 0;
  std::uint32_t request_line_ = 0;
  std::uint32_t request_byte_ = 0;
  bool need_link_ = false;

  // Links that have been read, in order, and not yet followed.
  std::array<std::uint32_t, 2> links_{};
  std::size_t links_held_ = 0;

  // Side of the data.
  bool data_open_ = false;
  std::uint32_t data_left_ = 0;  ///< records not yet gathered
  std::uint32_t data_chunk_ = 0;
  std::uint32_t data_next_ = 0;
  std::uint32_t data_line_ = 0;
  std::uint32_t hand_left_ = 0;  ///< records of the first task not yet handed out
  Line line_;                    ///< being handed out
  Line incoming_;                ///< being gathered
};

}  // namespace fasttree::model::ft2
