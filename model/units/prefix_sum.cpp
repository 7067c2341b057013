// SPDX-License-Identifier: Apache-2.0
#include "model/units/prefix_sum.h"

#include <algorithm>
#include <type_traits>

namespace fasttree::model {
namespace {

enum Stall : std::size_t { kTaker };

template <std::uint32_t kLength>
void up_sweep_of(std::uint32_t* values) {
  for (std::uint32_t stride = 1; stride < kLength; stride *= 2) {
    for (std::uint32_t i = 2 * stride - 1; i < kLength; i += 2 * stride) {
      values[i] += values[i - stride];
    }
  }
}

template <std::uint32_t kLength>
std::uint32_t down_sweep_of(std::uint32_t* values) {
  const std::uint32_t total = values[kLength - 1];
  values[kLength - 1] = 0;
  for (std::uint32_t stride = kLength / 2; stride > 0; stride /= 2) {
    for (std::uint32_t i = 2 * stride - 1; i < kLength; i += 2 * stride) {
      const std::uint32_t left = values[i - stride];
      values[i - stride] = values[i];
      values[i] += left;
    }
  }
  return total;
}

// The lengths a section can have, as constants: these loops are where a simulation spends its time.
template <typename Body>
void with_length(std::uint32_t section, const Body& body) {
  switch (section) {
    case 2:
      return body(std::integral_constant<std::uint32_t, 2>{});
    case 4:
      return body(std::integral_constant<std::uint32_t, 4>{});
    case 8:
      return body(std::integral_constant<std::uint32_t, 8>{});
    case 16:
      return body(std::integral_constant<std::uint32_t, 16>{});
    case 32:
      return body(std::integral_constant<std::uint32_t, 32>{});
    default:
      return body(std::integral_constant<std::uint32_t, 64>{});
  }
}

}  // namespace

void up_sweep(std::uint32_t* values, std::uint32_t section) {
  with_length(section, [&](auto length) { up_sweep_of<length()>(values); });
}

std::uint32_t down_sweep(std::uint32_t* values, std::uint32_t section) {
  std::uint32_t total = 0;
  with_length(section, [&](auto length) { total = down_sweep_of<length()>(values); });
  return total;
}

PrefixSumUnit::PrefixSumUnit(std::string name, const PaperConfig::PrefixSum& config)
    : Unit(std::move(name), "prefix_sum", {"radix_sort"}),
      input(2),
      output(2),
      section_(config.section),
      stages_(std::max<std::uint32_t>(config.stages, 2)) {}

// From the last stage to the first, so that a section moves where the one before it has moved. The
// sweeps are whole in the first and last stage; stages between them only take their time.
void PrefixSumUnit::tick() {
  if (held_ == 0 && !input.valid()) {
    idle();
    return;
  }
  bool moved = false;
  for (std::size_t s = stages_.size(); s-- > 0;) {
    Stage& stage = stages_[s];
    if (!stage.full) continue;
    if (s + 1 == stages_.size()) {
      if (!output.ready()) continue;
      output.push(stage.section);
      --held_;
    } else {
      Stage& next = stages_[s + 1];
      if (next.full) continue;
      next.section = stage.section;
      next.full = true;
      if (s + 2 == stages_.size()) {
        next.section.total = down_sweep(next.section.values, section_);
      }
    }
    stage.full = false;
    moved = true;
  }
  if (input.valid() && !stages_.front().full) {
    stages_.front().section = input.pop();
    stages_.front().full = true;
    ++held_;
    up_sweep(stages_.front().section.values, section_);
    moved = true;
  }
  if (moved) {
    busy();
  } else {
    stalled(kTaker);
  }
}

bool PrefixSumUnit::done() const {
  return input.empty() && output.empty() && held_ == 0;
}

std::string PrefixSumUnit::waits_for() const {
  if (stages_.back().full) return "radix_sort to take a section's sums";
  return {};
}

}  // namespace fasttree::model
