// SPDX-License-Identifier: Apache-2.0
#include "model/units/mark_cache.h"

#include <algorithm>
#include <cstring>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBus, kPathCompression };

}  // namespace

MarkCache::MarkCache(const PaperConfig& config, BusPort& port)
    : Unit("mark_cache", "mark_cache", {"bus", "path_compression"}),
      requests(2),
      answers(2),
      config_(config.mark_cache),
      port_(port),
      sets_(config_.bytes / (config_.ways * config_.block_bytes)),
      blocks_(std::size_t{sets_} * config_.ways),
      data_(blocks_.size() * config_.block_bytes) {}

std::uint8_t* MarkCache::data(const Block* block) {
  return data_.data() + static_cast<std::size_t>(block - blocks_.data()) * config_.block_bytes;
}

MarkCache::Block* MarkCache::find(std::uint64_t number) {
  Block* set = blocks_.data() + number % sets_ * config_.ways;
  for (Block* block = set; block != set + config_.ways; ++block) {
    if (block->valid && block->number == number) return block;
  }
  return nullptr;
}

MarkCache::Block* MarkCache::victim(std::uint64_t number) {
  Block* set = blocks_.data() + number % sets_ * config_.ways;
  Block* chosen = set;
  for (Block* block = set; block != set + config_.ways; ++block) {
    if (!block->valid) return block;
    const bool better =
        broken_replacement_ ? block->used > chosen->used : block->used < chosen->used;
    if (better) chosen = block;
  }
  return chosen;
}

void MarkCache::look_up() {
  request_ = requests.pop();
  const std::uint64_t number = request_.address.value / config_.block_bytes;
  block_ = find(number);
  const bool hit = block_ != nullptr;
  if (!hit) block_ = victim(number);
  block_->used = ++uses_;
  ++(request_.write ? statistics_.writes : statistics_.reads);
  if (hit) {
    ++(request_.write ? statistics_.write_hits : statistics_.read_hits);
    wait_ = config_.hit_latency;
    state_ = State::hit;
  } else {
    wait_ = config_.miss_penalty;
    asked_ = false;
    state_ = State::miss;
  }
}

void MarkCache::tick() {
  if (state_ == State::ready) {
    if (!requests.valid()) {
      idle();
      return;
    }
    look_up();
  }
  if (state_ == State::miss) {
    if (wait_ > 0) {
      --wait_;
      busy();
      return;
    }
    state_ = block_->valid && block_->dirty ? State::write_back : State::fetch;
  }
  if (state_ == State::write_back && !write_back()) {
    stalled(kBus);
    return;
  }
  if (state_ == State::fetch && !fetch()) {
    stalled(kBus);
    return;
  }
  // What is left is a hit, in its last cycles.
  if (state_ == State::hit && wait_ > 1) {
    --wait_;
    busy();
    return;
  }
  if (state_ == State::hit) {
    if (!request_.write && !answers.ready()) {
      stalled(kPathCompression);
      return;
    }
    finish();
  }
  if (state_ == State::write_through && !write_back()) {
    stalled(kBus);
    return;
  }
  busy();
}

bool MarkCache::write_back() {
  if (!port_.requests.ready()) return false;
  BusRequest out;
  out.address = Address(block_->number * config_.block_bytes);
  out.bytes = config_.block_bytes;
  out.write = true;
  out.purpose = Purpose::marks;
  std::memcpy(out.data.data(), data(block_), config_.block_bytes);
  port_.requests.push(out);
  ++statistics_.write_backs;
  block_->dirty = false;
  state_ = state_ == State::write_through ? State::ready : State::fetch;
  return true;
}

bool MarkCache::fetch() {
  if (!asked_) {
    if (!port_.requests.ready()) return false;
    block_->valid = false;
    block_->number = request_.address.value / config_.block_bytes;
    BusRequest in;
    in.address = Address(block_->number * config_.block_bytes);
    in.bytes = config_.block_bytes;
    in.purpose = Purpose::marks;
    port_.requests.push(in);
    asked_ = true;
    return false;
  }
  if (port_.data.visible() < config_.block_bytes) return false;
  port_.data.pop(data(block_), config_.block_bytes);
  block_->valid = true;
  block_->dirty = false;
  wait_ = 1;
  state_ = State::hit;
  return true;
}

void MarkCache::finish() {
  std::uint8_t* word = data(block_) + request_.address.value % config_.block_bytes;
  state_ = State::ready;
  if (!request_.write) {
    std::uint32_t marks = 0;
    std::memcpy(&marks, word, sizeof marks);
    answers.push(marks);
    return;
  }
  std::memcpy(word, &request_.word, sizeof request_.word);
  block_->dirty = true;
  if (!config_.write_back) state_ = State::write_through;
}

bool MarkCache::done() const {
  return state_ == State::ready && requests.empty() && answers.empty();
}

std::string MarkCache::waits_for() const {
  if (state_ == State::fetch) return "the bus for a block of marks";
  if (state_ == State::write_back || state_ == State::write_through)
    return "the bus to take a block of marks";
  return {};
}

void MarkCache::copy_dirty(Address base, std::vector<std::uint8_t>& bytes) const {
  for (const Block& block : blocks_) {
    if (!block.valid || !block.dirty) continue;
    const std::uint64_t at = block.number * config_.block_bytes - base.value;
    if (at >= bytes.size()) continue;
    const std::size_t count = std::min<std::uint64_t>(config_.block_bytes, bytes.size() - at);
    std::memcpy(
        bytes.data() + at,
        data_.data() + static_cast<std::size_t>(&block - blocks_.data()) * config_.block_bytes,
        count);
  }
}

}  // namespace fasttree::model
