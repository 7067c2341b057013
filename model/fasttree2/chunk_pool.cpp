// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/chunk_pool.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <string>

namespace fasttree::model::ft2 {

namespace {
enum Reason : std::size_t { kMemory };
}  // namespace

ChunkPool::ChunkPool(Registers& registers, Dma& dma)
    : Unit("chunk_pool", "radix_sort", {"memory"}),
      r_(registers),
      read_(dma.add_read("free chunks", kSpillBytes)),
      write_(dma.add_write("free chunks", kSpillBytes)),
      // Spilling and refilling both leave half of it, so that they do not follow each other.
      slots_(std::max(registers.config.free_chunks, 3 * kSpillIds)) {
  free_.reserve(slots_);
}

void ChunkPool::begin(std::uint32_t first) {
  next_ = first;
  free_.clear();
  spilled_lines_ = 0;
  exhausted_ = false;
}

std::uint32_t ChunkPool::allocate() {
  assert(can_allocate());
  if (!free_.empty()) {
    const std::uint32_t chunk = free_.back();
    free_.pop_back();
    return chunk;
  }
  if (next_ >= r_.layout.chunk_count) {
    exhausted_ = true;
    return 0;
  }
  return next_++;
}

void ChunkPool::tick() {
  if (refilling_) {
    if (!read_.valid()) return stalled(kMemory);
    const Beat& beat = read_.front();
    const std::uint32_t count = beat.bytes / 4;
    for (std::uint32_t i = 0; i < count; ++i) {
      std::uint32_t chunk = 0;
      std::memcpy(&chunk, beat.data.data() + 4 * i, 4);
      free_.push_back(chunk);
    }
    read_.pop();
    refill_left_ -= count;
    refilling_ = refill_left_ > 0;
    return busy();
  }
  const auto line = [&](std::uint64_t i) { return r_.layout.spill + Address(i * kSpillBytes); };
  if (free_.size() + 2 > slots_) {
    if (!write_.ready(line(spilled_lines_), kSpillBytes)) return stalled(kMemory);
    std::uint8_t bytes[kSpillBytes];
    std::memcpy(bytes, free_.data() + free_.size() - kSpillIds, kSpillBytes);
    free_.resize(free_.size() - kSpillIds);
    write_.write(line(spilled_lines_++), bytes, kSpillBytes);
    return busy();
  }
  // Read back only what the memory has accepted.
  if (free_.size() < kSpillIds && spilled_lines_ > 0 && write_.drained()) {
    Address at = line(--spilled_lines_);
    for (std::uint32_t left = kSpillBytes; left > 0;) {
      const std::uint32_t bytes = std::min(left, read_.beat_bytes());
      if (!read_.ready()) break;
      read_.request(at, bytes);
      at += Address(bytes);
      left -= bytes;
    }
    refill_left_ = kSpillIds;
    refilling_ = true;
    return busy();
  }
  idle();
}

std::string ChunkPool::waits_for() const {
  return refilling_ ? "memory for spilled free chunks" : "";
}

}  // namespace fasttree::model::ft2
