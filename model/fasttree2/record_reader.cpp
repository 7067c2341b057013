// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/record_reader.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace fasttree::model::ft2 {

RecordReader::RecordReader(Registers& registers, Dma& dma, ChunkPool& pool, const std::string& user)
    : r_(registers),
      port_(dma.add_read("records of " + user, registers.config.record_prefetch_bytes)),
      pool_(pool) {}

void RecordReader::start(const BucketChain& chain) {
  assert(can_start() && chain.count > 0);
  tasks_[(tasks_head_ + tasks_held_++) % tasks_.size()] = chain;
  if (tasks_held_ == 1) hand_left_ = chain.count;
}

void RecordReader::request() {
  if (!request_open_) {
    if (requesting_ == tasks_held_) return;
    const BucketChain& task = tasks_[(tasks_head_ + requesting_) % tasks_.size()];
    request_open_ = true;
    request_left_ = task.count;
    request_chunk_ = task.head;
    request_line_ = 0;
    request_byte_ = 0;
    need_link_ = false;
  }
  if (need_link_) {
    if (links_held_ == 0) return;
    request_chunk_ = links_[0];
    links_[0] = links_[1];
    --links_held_;
    need_link_ = false;
  }
  if (!port_.ready()) return;
  const std::uint32_t records = std::min(request_left_, r_.chunks.records(request_line_));
  const std::uint32_t wanted = r_.chunks.offset(request_line_) + records * r_.chunks.record_bytes;
  const std::uint32_t bytes = std::min(port_.beat_bytes(), wanted - request_byte_);
  port_.request(r_.layout.chunks +
                    Address(std::uint64_t{request_chunk_} * r_.chunks.chunk_bytes +
                            std::uint64_t{request_line_} * r_.chunks.line_bytes + request_byte_),
                bytes);
  request_byte_ += bytes;
  if (request_byte_ < wanted) return;
  request_byte_ = 0;
  request_left_ -= records;
  if (request_left_ == 0) {
    request_open_ = false;
    ++requesting_;
  } else if (++request_line_ == r_.chunks.lines()) {
    request_line_ = 0;
    need_link_ = true;
  }
}

void RecordReader::gather() {
  if (incoming_.wanted == 0) {
    if (!data_open_) {
      if (gathered_ == tasks_held_) return;
      const BucketChain& task = tasks_[(tasks_head_ + gathered_) % tasks_.size()];
      data_open_ = true;
      data_left_ = task.count;
      data_chunk_ = task.head;
      data_line_ = 0;
    }
    incoming_.records = std::min(data_left_, r_.chunks.records(data_line_));
    incoming_.wanted = r_.chunks.offset(data_line_) + incoming_.records * r_.chunks.record_bytes;
    incoming_.offset = r_.chunks.offset(data_line_);
    incoming_.held = 0;
    incoming_.next = 0;
  }
  if (incoming_.held < incoming_.wanted && port_.valid()) {
    const bool last_beat = incoming_.held + port_.front().bytes >= incoming_.wanted;
    const bool last_of_chunk =
        data_left_ == incoming_.records || data_line_ + 1 == r_.chunks.lines();
    // The chunk is free once its last byte is here.
    if (last_beat && last_of_chunk && !pool_.can_release()) return;
    std::copy_n(port_.front().data.begin(), port_.front().bytes,
                incoming_.bytes.begin() + incoming_.held);
    incoming_.held += port_.front().bytes;
    port_.pop();
    if (last_beat) {
      if (data_line_ == 0 && data_left_ > r_.chunks.records_of_chunk()) {
        std::memcpy(&data_next_, incoming_.bytes.data(), ChunkFormat::kLinkBytes);
        if (data_next_ >= r_.layout.chunk_count) {
          r_.fail("record_reader: chunk " + std::to_string(data_chunk_) + " names chunk " +
                  std::to_string(data_next_) + ", which does not exist");
          data_next_ = 0;
        }
        links_[links_held_++] = data_next_;
      }
      if (last_of_chunk) pool_.release(data_chunk_);
    }
  }
  if (incoming_.held < incoming_.wanted || valid()) return;
  // Handed over as a whole; the next line is gathered beside it.
  data_left_ -= incoming_.records;
  if (++data_line_ == r_.chunks.lines()) {
    data_line_ = 0;
    data_chunk_ = data_next_;
  }
  if (data_left_ == 0) {
    data_open_ = false;
    ++gathered_;
  }
  std::swap(line_, incoming_);
  incoming_.wanted = 0;
}

void RecordReader::step() {
  request();
  gather();
}

Record RecordReader::front() const {
  return r_.records.unpack(line_.bytes.data() + line_.offset +
                           std::size_t{line_.next} * r_.chunks.record_bytes);
}

void RecordReader::pop() {
  assert(valid());
  ++line_.next;
  if (--hand_left_ == 0) {
    tasks_head_ = (tasks_head_ + 1) % tasks_.size();
    --tasks_held_;
    --requesting_;
    --gathered_;
    if (tasks_held_ > 0) hand_left_ = tasks_[tasks_head_].count;
  }
}

}  // namespace fasttree::model::ft2
