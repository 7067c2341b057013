// SPDX-License-Identifier: Apache-2.0
// Samples of a run whose length is not known before: windows double when there are too many.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "model/kernel/unit.h"
#include "model/report/simulation.h"

namespace fasttree::model {

class Timeline {
 public:
  /// Between `windows` and twice as many samples come out of a long run; 0: none. `moved_bytes`:
  /// over the bus so far.
  Timeline(std::uint32_t windows, std::vector<const Unit*> units,
           std::function<std::uint64_t()> moved_bytes)
      : windows_(windows), units_(std::move(units)), moved_bytes_(std::move(moved_bytes)) {
    busy_.resize(units_.size());
    stalled_.resize(units_.size());
  }

  /// At the end of each cycle.
  void tick(std::uint64_t cycle) {
    if (windows_ != 0 && cycle - begin_ >= window_) sample(cycle);
  }
  /// Before the units' accounts of a stage are closed, and at the end.
  void sample(std::uint64_t cycle);
  /// The accounts begin anew.
  void begin_stage();

  std::vector<TimelineSample> take() { return std::move(samples_); }

 private:
  void halve();

  std::uint32_t windows_;
  std::vector<const Unit*> units_;
  std::function<std::uint64_t()> moved_bytes_;
  std::uint32_t window_ = 256;
  std::uint64_t begin_ = 0;
  std::uint64_t bytes_ = 0;
  std::vector<std::uint64_t> busy_, stalled_;  ///< in the stage so far, a unit
  std::vector<TimelineSample> samples_;
};

}  // namespace fasttree::model
