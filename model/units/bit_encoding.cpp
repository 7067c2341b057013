// SPDX-License-Identifier: Apache-2.0
#include "model/units/bit_encoding.h"

#include <algorithm>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBus, kMarkCache };

}  // namespace

BitEncodingUnit::BitEncodingUnit(const PaperConfig& config, BusPort& port,
                                 Queue<MarkRequest>& cache)
    : Unit("beu", "bit_encoding", {"bus", "mark_cache"}),
      input(config.internal_node.queue),
      port_(port),
      cache_(cache) {}

void BitEncodingUnit::start_clear(Address marks, std::uint64_t bytes) {
  clear_next_ = marks.value;
  clear_end_ = marks.value + bytes;
}

void BitEncodingUnit::start_marks(Address marks, std::uint32_t nodes) {
  marks_ = marks.value;
  left_ = nodes;
  holds_ = false;
}

void BitEncodingUnit::tick() {
  if (clear_next_ < clear_end_) {
    if (clear()) {
      busy();
    } else {
      stalled(kBus);
    }
  } else if (holds_ || input.valid()) {
    if (mark()) {
      busy();
    } else if (left_ > 0 && !input.valid()) {
      idle();
    } else {
      stalled(kMarkCache);
    }
  } else {
    idle();
  }
}

bool BitEncodingUnit::clear() {
  if (!port_.requests.ready()) return false;
  BusRequest zeros;
  zeros.data.fill(0);
  zeros.address = Address(clear_next_);
  zeros.bytes = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(kMaxRequestBytes, clear_end_ - clear_next_));
  zeros.write = true;
  zeros.purpose = Purpose::clear;
  port_.requests.push(zeros);
  clear_next_ += zeros.bytes;
  return true;
}

// Nodes come in order, so that a word is complete when a node of another word comes.
bool BitEncodingUnit::mark() {
  const bool have = input.valid();
  const std::uint32_t index = have ? input.front() / 32 : 0;
  const bool write = holds_ && (have ? index != word_index_ : left_ == 0);
  if (write) {
    if (!cache_.ready()) return false;
    cache_.push({Address(marks_ + std::uint64_t{word_index_} * 4), true, word_});
    holds_ = false;
  }
  if (have) {
    if (!holds_) word_ = 0;
    word_ |= 1u << input.pop() % 32;
    word_index_ = index;
    holds_ = true;
    --left_;
  }
  return have || write;
}

bool BitEncodingUnit::done() const {
  return clear_next_ >= clear_end_ && left_ == 0 && !holds_;
}

std::string BitEncodingUnit::waits_for() const {
  if (clear_next_ < clear_end_) return "the bus to take zeros";
  if (holds_ && left_ == 0) return "mark_cache to take a word";
  if (left_ > 0) return "internal_node for " + std::to_string(left_) + " more nodes";
  return {};
}

}  // namespace fasttree::model
