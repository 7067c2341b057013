// SPDX-License-Identifier: Apache-2.0
#include "model/units/internal_node.h"

#include <algorithm>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBus, kSplitPlane, kBitEncoding };

}  // namespace

InternalNodeUnit::InternalNodeUnit(const PaperConfig& config, BusPort& port,
                                   Queue<SplitJob>& splits, Queue<std::uint32_t>& marks)
    : Unit("ingu", "internal_node", {"bus", "split_plane", "bit_encoding"}),
      config_(config),
      reader_(port, config.bus.burst_bytes),
      splits_(splits),
      marks_(marks) {}

void InternalNodeUnit::start(Address leaf_codes, std::uint32_t leaves) {
  reader_.start(leaf_codes, std::uint64_t{leaves} * 4, Purpose::leaf_codes);
  left_ = leaves;
  first_ = true;
  shifting_ = false;
}

bool InternalNodeUnit::load() {
  if (left_ == 0 || reader_.available() < 4) {
    waits_ = kBus;
    return false;
  }
  std::uint32_t code = 0;
  reader_.take(&code, sizeof code);
  --left_;
  if (!first_) {
    different_ = code_ ^ code;
    shifts_ = 0;
    shifting_ = true;
  }
  first_ = false;
  code_ = code;
  return true;
}

// A node takes m + 1 shifts of one bit: nothing is left after that many.
void InternalNodeUnit::tick() {
  reader_.tick();
  bool worked = false;
  if (!shifting_) {
    if (done()) {
      idle();
      return;
    }
    worked = load();
  }
  if (shifting_) {
    for (std::uint32_t i = 0; i < config_.internal_node.shifts_per_cycle && different_ != 0; ++i) {
      different_ >>= 1;
      ++shifts_;
      worked = true;
    }
    if (different_ == 0) {
      if (!splits_.ready()) {
        waits_ = kSplitPlane;
      } else if (!marks_.ready()) {
        waits_ = kBitEncoding;
      } else {
        const std::int32_t m = std::max(shifts_ - 1, 0);  // equal codes, which no sort makes
        splits_.push({code_, m});
        marks_.push(code_ >> m << m << 1);
        shifting_ = false;
        worked = true;
      }
    }
  }
  if (worked) {
    busy();
  } else {
    stalled(waits_);
  }
}

std::string InternalNodeUnit::waits_for() const {
  if (done()) return {};
  if (!shifting_) return std::to_string(left_) + " codes of leaves from the bus";
  return waits_ == kSplitPlane ? "split_plane to take a node" : "bit_encoding to take a node";
}

}  // namespace fasttree::model
