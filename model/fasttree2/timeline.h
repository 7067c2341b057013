// SPDX-License-Identifier: Apache-2.0
// Samples of all units' accounts in windows of equal length. Windows double in length, two becoming
// one, when there are twice as many as asked for: nobody knows beforehand how long a run takes.
#pragma once

#include <cstdint>
#include <vector>

#include "model/kernel/unit.h"
#include "model/report/simulation.h"

namespace fasttree::model::ft2 {

class Timeline {
 public:
  /// `windows` 0: nothing is kept. The list of units may be filled later.
  Timeline(const std::vector<Unit*>& units, std::uint32_t windows);

  /// After each cycle; does something at the end of a window only.
  void clock(std::uint64_t cycle, std::uint64_t bus_bytes) {
    if (cycle == next_) sample(cycle, bus_bytes);
  }
  /// The rest, and all samples.
  std::vector<TimelineSample> finish(std::uint64_t cycle, std::uint64_t bus_bytes);

 private:
  void sample(std::uint64_t cycle, std::uint64_t bus_bytes);
  void halve();

  const std::vector<Unit*>& units_;
  std::uint32_t windows_;
  std::uint64_t length_ = 64;
  std::uint64_t begin_ = 0;
  std::uint64_t next_ = 0;
  std::uint64_t bytes_ = 0;
  std::vector<std::uint64_t> busy_, stalled_;  ///< a unit, up to the last sample
  std::vector<TimelineSample> samples_;
};

}  // namespace fasttree::model::ft2
