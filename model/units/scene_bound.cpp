// SPDX-License-Identifier: Apache-2.0
#include "model/units/scene_bound.h"

#include <algorithm>
#include <bit>

namespace fasttree::model {

SceneBoundUnit::SceneBoundUnit(Side side, const PaperConfig::SceneBound& config)
    : Unit(side == Side::lower ? "sbcu_lower" : "sbcu_upper", "scene_bound", {}),
      input(config.queue),
      side_(side),
      inputs_(config.inputs),
      stages_(static_cast<std::size_t>(std::countr_zero(config.inputs))) {}

float SceneBoundUnit::select(float a, float b) const {
  const bool second = side_ == Side::lower ? b < a : b > a;
  return second ? b : a;
}

// Nothing behind it can make it wait, so every stage moves in every cycle.
void SceneBoundUnit::tick() {
  bool worked = false;
  if (Stage& last = stages_.back(); last.full) {
    const std::size_t axis = last.group.axis;
    const float value = last.group.values[0];
    bound_[axis] = any_[axis] ? select(bound_[axis], value) : value;
    any_[axis] = true;
    last.full = false;
    worked = true;
  }
  const auto compare = [&](const CoordinateGroup& from, Stage& to, std::uint32_t values) {
    to.full = true;
    to.group.axis = from.axis;
    for (std::uint32_t i = 0; i < values; ++i) {
      to.group.values[i] = select(from.values[2 * i], from.values[2 * i + 1]);
    }
    worked = true;
  };
  for (std::size_t s = stages_.size(); s-- > 1;) {
    if (!stages_[s - 1].full) continue;
    compare(stages_[s - 1].group, stages_[s], inputs_ >> (s + 1));
    stages_[s - 1].full = false;
  }
  if (input.valid()) compare(input.pop(), stages_.front(), inputs_ / 2);
  if (worked) {
    busy();
  } else {
    idle();
  }
}

bool SceneBoundUnit::done() const {
  return input.empty() &&
         std::none_of(stages_.begin(), stages_.end(), [](const Stage& s) { return s.full; });
}

float SceneBoundUnit::bound(std::size_t axis) const {
  return bound_[axis] + 0.0f;
}

}  // namespace fasttree::model
