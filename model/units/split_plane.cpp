// SPDX-License-Identifier: Apache-2.0
#include "model/units/split_plane.h"

#include <algorithm>

#include "fasttree/device_image.h"
#include "grid/float_order.h"

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kBus };

}  // namespace

PlaneSearch::PlaneSearch(const AxisQuantiser& quantiser, float hi, std::uint32_t k)
    : quantiser_(quantiser),
      k_(k),
      phase_(Phase::first),
      least_(to_ordinal(quantiser.lo)),
      most_(to_ordinal(hi)) {
  const float guess = quantiser.lo + static_cast<float>(k) / quantiser.scale;
  start_ = std::clamp(to_ordinal(guess), least_, most_);
}

bool PlaneSearch::reached(std::int64_t ordinal) const {
  return quantiser_(from_ordinal(ordinal)) >= k_;
}

// The bounds of the axis need no trial: the lower is in cell 0, the upper in the last one.
void PlaneSearch::trial() {
  switch (phase_) {
    case Phase::first:
      if (reached(start_)) {
        above_ = start_;
        below_ = least_;
        phase_ = Phase::down;
      } else {
        below_ = start_;
        above_ = most_;
        phase_ = Phase::up;
      }
      break;
    case Phase::down: {
      const std::int64_t next = std::max(above_ - step_, least_);
      step_ *= 2;
      if (next == least_) {
        phase_ = Phase::halve;
      } else if (reached(next)) {
        above_ = next;
      } else {
        below_ = next;
        phase_ = Phase::halve;
      }
      break;
    }
    case Phase::up: {
      const std::int64_t next = std::min(below_ + step_, most_);
      step_ *= 2;
      if (next == most_) {
        phase_ = Phase::halve;
      } else if (reached(next)) {
        above_ = next;
        phase_ = Phase::halve;
      } else {
        below_ = next;
      }
      break;
    }
    case Phase::halve: {
      const std::int64_t middle = below_ + (above_ - below_) / 2;
      (reached(middle) ? above_ : below_) = middle;
      break;
    }
  }
}

float PlaneSearch::plane() const {
  return from_ordinal(above_);
}

SplitPlaneUnit::SplitPlaneUnit(const PaperConfig& config, BusPort& port)
    : Unit("split_plane", "internal_node", {"bus"}),
      input(config.internal_node.queue),
      config_(config),
      port_(port) {}

void SplitPlaneUnit::start(Address nodes, std::uint32_t count, const Grid& grid) {
  writer_.start(port_, kMaxRequestBytes, nodes, Purpose::nodes);
  grid_ = &grid;
  left_ = count;
  searching_ = false;
}

void SplitPlaneUnit::tick() {
  blocked_ = false;
  bool worked = false;
  if (!searching_ && input.valid()) {
    const SplitJob job = input.pop();
    // Codes that no sort has made can ask for a level that is not there.
    const int level = std::clamp(grid_->depth() - 1 - job.bit, 0, kMaxDepth - 1);
    axis_ = static_cast<std::uint32_t>(grid_->axis_of_level(level));
    const std::uint32_t cell = grid_->coordinate_of(job.upper_code >> job.bit << job.bit, axis_);
    search_ = PlaneSearch(grid_->quantiser(axis_), grid_->bounds().hi[axis_],
                          cell << (kMaxAxisBits - grid_->bits()[axis_]));
    searching_ = true;
    worked = true;
  }
  if (searching_) {
    for (std::uint32_t i = 0; i < config_.internal_node.plane_trials && !search_.found(); ++i) {
      search_.trial();
      worked = true;
    }
    if (search_.found()) {
      const DeviceInternalNode node{0, 0, search_.plane(), axis_};
      if (writer_.ready(sizeof node)) {
        writer_.put(&node, sizeof node);
        searching_ = false;
        --left_;
        worked = true;
      } else {
        blocked_ = true;
      }
    }
  } else if (left_ == 0 && writer_.holds()) {
    if (port_.requests.ready()) {
      writer_.flush();
      worked = true;
    } else {
      blocked_ = true;
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
