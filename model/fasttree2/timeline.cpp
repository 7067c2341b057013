// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/timeline.h"

#include <utility>

namespace fasttree::model::ft2 {

Timeline::Timeline(const std::vector<Unit*>& units, std::uint32_t windows)
    : units_(units), windows_(windows) {
  if (windows_ == 0) return;
  samples_.reserve(std::size_t{2} * windows_ + 1);
  next_ = length_;
}

void Timeline::sample(std::uint64_t cycle, std::uint64_t bus_bytes) {
  busy_.resize(units_.size());
  stalled_.resize(units_.size());
  TimelineSample& s = samples_.emplace_back();
  s.begin_cycle = begin_;
  s.cycles = static_cast<std::uint32_t>(cycle - begin_);
  s.bus_bytes = bus_bytes - bytes_;
  s.busy_cycles.reserve(units_.size());
  s.stalled_cycles.reserve(units_.size());
  for (std::size_t u = 0; u < units_.size(); ++u) {
    std::uint64_t busy = 0;
    std::uint64_t stalled = 0;
    for (const Activity& a : units_[u]->activity()) {
      busy += a.busy_cycles;
      stalled += a.stalled();
    }
    s.busy_cycles.push_back(static_cast<std::uint32_t>(busy - busy_[u]));
    s.stalled_cycles.push_back(static_cast<std::uint32_t>(stalled - stalled_[u]));
    busy_[u] = busy;
    stalled_[u] = stalled;
  }
  bytes_ = bus_bytes;
  begin_ = cycle;
  if (samples_.size() >= std::size_t{2} * windows_) halve();
  next_ = begin_ + length_;
}

void Timeline::halve() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i + 1 < samples_.size(); i += 2, ++kept) {
    TimelineSample& a = samples_[i];
    const TimelineSample& b = samples_[i + 1];
    a.cycles += b.cycles;
    a.bus_bytes += b.bus_bytes;
    for (std::size_t u = 0; u < units_.size(); ++u) {
      a.busy_cycles[u] += b.busy_cycles[u];
      a.stalled_cycles[u] += b.stalled_cycles[u];
    }
    if (kept != i) samples_[kept] = std::move(a);
  }
  samples_.resize(kept);
  length_ *= 2;
}

std::vector<TimelineSample> Timeline::finish(std::uint64_t cycle, std::uint64_t bus_bytes) {
  if (windows_ != 0 && cycle > begin_) sample(cycle, bus_bytes);
  return std::move(samples_);
}

}  // namespace fasttree::model::ft2
