// SPDX-License-Identifier: Apache-2.0
#include "model/system/timeline.h"

#include <algorithm>

namespace fasttree::model {

void Timeline::begin_stage() {
  std::fill(busy_.begin(), busy_.end(), 0);
  std::fill(stalled_.begin(), stalled_.end(), 0);
}

void Timeline::sample(std::uint64_t cycle) {
  if (windows_ == 0 || cycle == begin_) return;
  TimelineSample sample;
  sample.begin_cycle = begin_;
  sample.cycles = static_cast<std::uint32_t>(cycle - begin_);
  for (std::size_t u = 0; u < units_.size(); ++u) {
    const Activity& activity = units_[u]->activity().back();
    const std::uint64_t stalled = activity.stalled();
    sample.busy_cycles.push_back(static_cast<std::uint32_t>(activity.busy_cycles - busy_[u]));
    sample.stalled_cycles.push_back(static_cast<std::uint32_t>(stalled - stalled_[u]));
    busy_[u] = activity.busy_cycles;
    stalled_[u] = stalled;
  }
  const std::uint64_t moved = moved_bytes_();
  sample.bus_bytes = moved - bytes_;
  bytes_ = moved;
  begin_ = cycle;
  samples_.push_back(std::move(sample));
  if (samples_.size() >= 2 * std::size_t{windows_}) halve();
}

void Timeline::halve() {
  std::vector<TimelineSample> merged;
  for (std::size_t i = 0; i < samples_.size(); i += 2) {
    TimelineSample& sample = merged.emplace_back(std::move(samples_[i]));
    if (i + 1 == samples_.size()) break;
    const TimelineSample& next = samples_[i + 1];
    sample.cycles += next.cycles;
    sample.bus_bytes += next.bus_bytes;
    for (std::size_t u = 0; u < units_.size(); ++u) {
      sample.busy_cycles[u] += next.busy_cycles[u];
      sample.stalled_cycles[u] += next.stalled_cycles[u];
    }
  }
  samples_ = std::move(merged);
  window_ *= 2;
}

}  // namespace fasttree::model
