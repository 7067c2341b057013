// SPDX-License-Identifier: Apache-2.0
#include "model/units/path_compression.h"

#include <bit>
#include <cstring>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBusRead, kBusWrite, kMarkCache };

}  // namespace

PathCompressionUnit::PathCompressionUnit(const PaperConfig& config, BusPort& reads, BusPort& links,
                                         Queue<MarkRequest>& cache, Queue<std::uint32_t>& marks)
    : Unit("pcu", "path_compression", {"bus (reading)", "bus (writing)", "mark_cache"}),
      config_(config),
      reader_(reads, config.bus.burst_bytes),
      link_port_(links),
      cache_(cache),
      marks_(marks) {}

void PathCompressionUnit::start(Address leaf_codes, std::uint32_t leaves, Address marks,
                                Address nodes, std::uint32_t depth) {
  reader_.start(leaf_codes, std::uint64_t{leaves} * 4, Purpose::leaf_codes);
  leaves_ = left_ = leaves;
  mark_base_ = marks.value;
  node_base_ = nodes.value;
  root_index_ = 1u << depth;
  state_ = State::next_leaf;
  root_ = kDeviceLeaf;
  steps_ = 0;
}

// What has arrived is done with, and the next climb begins in the same cycle.
void PathCompressionUnit::tick() {
  reader_.tick();
  bool worked = false;
  if (state_ == State::mark) worked = arrive();
  if (state_ == State::next_leaf) worked |= next_leaf();
  if (state_ == State::climb) worked |= climb();
  if (worked) {
    busy();
  } else if (done()) {
    idle();
  } else {
    stalled(waits_);
  }
}

bool PathCompressionUnit::next_leaf() {
  if (left_ == 0) return false;
  if (reader_.available() < 4) {
    waits_ = kBusRead;
    return false;
  }
  std::uint32_t code = 0;
  reader_.take(&code, sizeof code);
  leaf_ = first_ = leaves_ - left_;
  --left_;
  child_ = leaf_ | kDeviceLeaf;
  node_ = code << 1 | 1u;
  wait_ = config_.path_compression.step_cycles;
  state_ = State::climb;
  return true;
}

// One step up, by the lowest set bit and the one above it; then a look at the parent's mark.
bool PathCompressionUnit::climb() {
  // Only codes that no sort has made lead above the root.
  if (node_ == root_index_ || (node_ & 0x7fffffffu) == 0) {
    root_ = child_;  // no essential ancestor
    state_ = State::next_leaf;
    return true;
  }
  if (wait_ > 1) {
    --wait_;
    return true;
  }
  if (!cache_.ready()) {
    waits_ = kMarkCache;
    return false;
  }
  const int i = std::countr_zero(node_);
  upper_child_ = node_ >> (i + 1) & 1u;
  parent_ = (node_ & ~(1u << i)) | 1u << (i + 1);
  cache_.push({Address(mark_base_ + parent_ / 32 * 4), false, 0});
  ++steps_;
  state_ = State::mark;
  return true;
}

bool PathCompressionUnit::arrive() {
  if (!marks_.valid()) {
    waits_ = kMarkCache;
    return false;
  }
  const bool essential = marks_.front() >> parent_ % 32 & 1u;
  if (essential && !link_port_.requests.ready()) {
    waits_ = kBusWrite;
    return false;
  }
  marks_.drop();
  node_ = parent_;
  wait_ = config_.path_compression.step_cycles;
  state_ = State::climb;
  if (!essential) return true;

  const auto level = static_cast<std::size_t>(std::countr_zero(parent_));
  const std::uint32_t rank = upper_child_ ? first_ - 1 : leaf_;
  BusRequest link;
  link.address = Address(node_base_ + std::uint64_t{rank} * sizeof(DeviceInternalNode) +
                         (upper_child_ ? 4 : 0));
  link.bytes = sizeof child_;
  link.write = true;
  link.purpose = Purpose::links;
  std::memcpy(link.data.data(), &child_, sizeof child_);
  link_port_.requests.push(link);
  if (upper_child_) {
    child_ = rank;
    first_ = first_leaf_[level];
  } else {
    first_leaf_[level] = first_;
    state_ = State::next_leaf;
  }
  return true;
}

std::string PathCompressionUnit::waits_for() const {
  if (done()) return {};
  if (state_ == State::mark) return "mark_cache for the mark of node " + std::to_string(parent_);
  if (state_ == State::climb) return "mark_cache to take a request";
  return std::to_string(left_) + " codes of leaves from the bus";
}

}  // namespace fasttree::model
