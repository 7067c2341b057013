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
      section_(config.section),
      full_(std::max<std::uint32_t>(config.stages, 2)),
      sections_(full_.size() + 1) {}

// The sums are made at once; the stages only take their time.
void PrefixSumUnit::push(const Section& section) {
  assert(ready());
  Section& sums = sections_[slot(held_)];
  sums = section;
  up_sweep(sums.values, section_);
  sums.total = down_sweep(sums.values, section_);
  pushed_ = true;
}

// From the last stage to the first, so that a section moves where the one before it has moved.
void PrefixSumUnit::clock() {
  if (!ticked_) return;
  ticked_ = false;
  const bool nothing = held_ == 0 && !pushed_;
  bool moved = pushed_ || taken_;
  if (taken_) {
    full_.back() = false;
    first_ = slot(1);
    --held_;
  }
  for (std::size_t s = full_.size() - 1; s-- > 0;) {
    if (!full_[s] || full_[s + 1]) continue;
    full_[s] = false;
    full_[s + 1] = true;
    moved = true;
  }
  if (pushed_) {
    full_.front() = true;
    ++held_;
  }
  pushed_ = taken_ = false;
  if (nothing) {
    idle();
  } else if (moved) {
    busy();
  } else {
    stalled(kTaker);
  }
}

std::string PrefixSumUnit::waits_for() const {
  if (full_.back()) return "radix_sort to take a section's sums";
  return {};
}

}  // namespace fasttree::model
