// SPDX-License-Identifier: Apache-2.0
#include "model/units/split_plane.h"

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBus };

DeviceInternalNode node_of(const SplitJob& job, const Grid& grid) {
  // Codes that no sort has made can ask for a level that is not there.
  if (job.bit >= grid.depth()) return {};
  const Grid::Split split = grid.split_below(job.upper_code, job.bit);
  return {0, 0, split.position, split.axis};
}

}  // namespace

SplitPlaneUnit::SplitPlaneUnit(const PaperConfig& config, BusPort& port)
    : Unit("split_plane", "internal_node", {"bus"}),
      input(config.internal_node.queue),
      config_(config),
      port_(port) {}

void SplitPlaneUnit::start(Address nodes, std::uint32_t count, const Grid& grid) {
  writer_.start(port_, kMaxRequestBytes, nodes, Purpose::nodes);
  grid_ = &grid;
  left_ = count;
  records_.clear();
  moves_ = next_in_ = 0;
}

void SplitPlaneUnit::tick() {
  bool worked = false;
  const bool out = !records_.empty() && records_.front().out_at == moves_;
  blocked_ = out && !writer_.ready(sizeof(DeviceInternalNode));
  if (!blocked_) {
    worked = !records_.empty();
    if (out) {
      writer_.put(&records_.front().node, sizeof(DeviceInternalNode));
      records_.pop_front();
      --left_;
    }
    if (input.valid() && moves_ >= next_in_) {
      records_.push_back(
          {node_of(input.pop(), *grid_), moves_ + config_.internal_node.plane_latency});
      next_in_ = moves_ + config_.internal_node.plane_cycles;
      worked = true;
    }
    ++moves_;
  }
  if (!worked && left_ == 0 && writer_.holds()) {
    blocked_ = !port_.requests.ready();
    if (!blocked_) {
      writer_.flush();
      worked = true;
    }
  }
  if (worked) {
    busy();
  } else if (blocked_) {
    stalled(kBus);
  } else {
    idle();
  }
}

bool SplitPlaneUnit::done() const {
  return left_ == 0 && !writer_.holds();
}

std::string SplitPlaneUnit::waits_for() const {
  if (blocked_) return "the bus to take nodes";
  if (left_ > 0) return "internal_node for " + std::to_string(left_) + " more nodes";
  return {};
}

}  // namespace fasttree::model
