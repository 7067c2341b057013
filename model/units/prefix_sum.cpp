// SPDX-License-Identifier: Apache-2.0
#include "model/units/prefix_sum.h"

#include <algorithm>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kTaker };

}  // namespace

void up_sweep(std::uint32_t* values, std::uint32_t section) {
  for (std::uint32_t stride = 1; stride < section; stride *= 2) {
    for (std::uint32_t i = 2 * stride - 1; i < section; i += 2 * stride) {
      values[i] += values[i - stride];
    }
  }
}

std::uint32_t down_sweep(std::uint32_t* values, std::uint32_t section) {
  const std::uint32_t total = values[section - 1];
  values[section - 1] = 0;
  for (std::uint32_t stride = section / 2; stride > 0; stride /= 2) {
    for (std::uint32_t i = 2 * stride - 1; i < section; i += 2 * stride) {
      const std::uint32_t left = values[i - stride];
      values[i - stride] = values[i];
      values[i] += left;
    }
  }
  return total;
}

PrefixSumUnit::PrefixSumUnit(std::string name, const PaperConfig::PrefixSum& config)
    : Unit(std::move(name), "prefix_sum", {"radix_sort"}),
      input(2),
      output(2),
      section_(config.section),
      stages_(std::max<std::uint32_t>(config.stages, 2)) {}

bool PrefixSumUnit::holds_any() const {
  return std::any_of(stages_.begin(), stages_.end(), [](const Stage& s) { return s.full; });
}

// From the last stage to the first, so that a section moves where the one before it has moved. The
// sweeps are whole in the first and last stage; stages between them only take their time.
void PrefixSumUnit::tick() {
  const bool held = holds_any();
  bool moved = false;
  for (std::size_t s = stages_.size(); s-- > 0;) {
    Stage& stage = stages_[s];
    if (!stage.full) continue;
    if (s + 1 == stages_.size()) {
      if (!output.ready()) continue;
      output.push(stage.section);
    } else {
      Stage& next = stages_[s + 1];
      if (next.full) continue;
      next.section = stage.section;
      next.full = true;
      if (s + 2 == stages_.size()) {
        next.section.total = down_sweep(next.section.values.data(), section_);
      }
    }
    stage.full = false;
    moved = true;
  }
  if (input.valid() && !stages_.front().full) {
    stages_.front().section = input.pop();
    stages_.front().full = true;
    up_sweep(stages_.front().section.values.data(), section_);
    moved = true;
  }
  if (moved) {
    busy();
  } else if (held) {
    stalled(kTaker);
  } else {
    idle();
  }
}

bool PrefixSumUnit::done() const {
  return input.empty() && output.empty() && !holds_any();
}

std::string PrefixSumUnit::waits_for() const {
  if (stages_.back().full) return "radix_sort to take a section's sums";
  return {};
}

}  // namespace fasttree::model
