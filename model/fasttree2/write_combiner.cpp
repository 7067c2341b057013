// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/write_combiner.h"

#include <algorithm>
#include <cstring>

namespace fasttree::model::ft2 {

namespace {
enum Reason : std::size_t { kProducer, kMemory, kChunkPool };
}  // namespace

WriteCombiner::WriteCombiner(std::string name, Registers& registers, Dma& dma, ChunkPool& pool,
                             Queue<BucketRecord>& in, std::uint32_t most_buckets, bool static_heads)
    : Unit(std::move(name), "radix_sort", {"records", "memory", "chunk_pool"}),
      r_(registers),
      port_(dma.add_write("records", std::max(registers.config.write_buffer_bytes,
                                              2 * registers.config.combine_bytes))),
      pool_(pool),
      in_(in),
      static_heads_(static_heads),
      entries_(most_buckets),
      lines_(std::size_t{most_buckets} * registers.config.combine_bytes) {}

void WriteCombiner::begin(std::uint32_t buckets) {
  active_ = true;
  finishing_ = false;
  buckets_ = buckets;
  flushed_ = 0;
  std::fill_n(entries_.begin(), buckets, Entry());
}

Address WriteCombiner::address_of(const Entry& e) const {
  return r_.layout.chunks + Address(std::uint64_t{e.chunk} * r_.chunks.chunk_bytes +
                                    std::uint64_t{e.line} * r_.chunks.line_bytes);
}

bool WriteCombiner::append() {
  const BucketRecord& in = in_.front();
  Entry& e = entries_[in.bucket];
  const std::uint32_t line_bytes = r_.chunks.line_bytes;
  if (e.count == 0) {
    if (!static_heads_ && !pool_.can_allocate()) {
      reason_ = kChunkPool;
      return false;
    }
    e.head = e.chunk = static_heads_ ? in.bucket : pool_.allocate();
  }
  std::uint8_t* line = line_of(in.bucket);
  if (e.fill + 1 == r_.chunks.records(e.line)) {
    // The line is full with this record: it goes out in this cycle, or the record waits.
    if (!port_.ready(address_of(e), line_bytes)) {
      reason_ = kMemory;
      return false;
    }
    if (e.line == 0) {
      if (!pool_.can_allocate()) {
        reason_ = kChunkPool;
        return false;
      }
      e.next = pool_.allocate();
      std::uint32_t link = e.next;
      if (links_++ == r_.faults.wrong_link) ++link;
      std::memcpy(line, &link, ChunkFormat::kLinkBytes);
    }
  }
  r_.records.pack(in.record,
                  line + r_.chunks.offset(e.line) + std::size_t{e.fill} * r_.chunks.record_bytes);
  ++e.count;
  if (++e.fill == r_.chunks.records(e.line)) {
    port_.write(address_of(e), line, line_bytes);
    e.fill = 0;
    if (++e.line == r_.chunks.lines()) {
      e.chunk = e.next;
      e.line = 0;
    }
  }
  in_.pop();
  return true;
}

bool WriteCombiner::flush() {
  Entry& e = entries_[flushed_];
  if (e.count > 0) {
    const std::uint32_t bytes =
        e.fill == 0 ? 0 : r_.chunks.offset(e.line) + e.fill * r_.chunks.record_bytes;
    if (bytes > 0 && !port_.ready(address_of(e), bytes)) {
      reason_ = kMemory;
      return false;
    }
    // The chunk that was asked for and is not needed: the next one, or one that was just begun.
    const bool begun = e.line == 0 && e.fill == 0;
    if (e.line > 0 || begun) {
      if (!pool_.can_release()) {
        reason_ = kChunkPool;
        return false;
      }
      pool_.release(begun ? e.chunk : e.next);
    }
    if (bytes > 0) port_.write(address_of(e), line_of(flushed_), bytes);
  }
  if (++flushed_ == buckets_) active_ = false;
  return true;
}

void WriteCombiner::tick() {
  if (!active_) {
    if (in_.valid()) in_.pop();
    return idle();
  }
  bool worked = false;
  if (in_.valid()) {
    worked = append();
  } else if (finishing_ && in_.empty()) {
    worked = flush();
  } else {
    reason_ = kProducer;
  }
  worked ? busy() : stalled(reason_);
}

std::string WriteCombiner::waits_for() const {
  if (!active_) return port_.drained() ? "" : "the dma to write its lines";
  switch (reason_) {
    case kMemory:
      return "room in its write buffer";
    case kChunkPool:
      return "a free chunk, or room for one, in the chunk_pool";
    default:
      return finishing_ ? "" : "records, or the end of them";
  }
}

}  // namespace fasttree::model::ft2
