// SPDX-License-Identifier: Apache-2.0
// The account of the RTL's units, as the model's units keep it of themselves.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/unit.h"

namespace fasttree::rtl {

/// A unit of the RTL: it says of each cycle what it does (`activity` of the module).
class RecordedUnit : public model::Unit {
 public:
  RecordedUnit(std::string name, std::string kind, std::vector<std::string> stall_reasons)
      : Unit(std::move(name), std::move(kind), std::move(stall_reasons)) {}

  /// 0: idle, 1: busy, 2 + r: stalled on reason r.
  void record(std::uint32_t activity) {
    if (activity == 1) {
      busy();
    } else if (activity >= 2 && activity - 2 < stall_reasons().size()) {
      stalled(activity - 2);
    } else {
      idle();
    }
  }

  void tick() override {}
  bool done() const override { return true; }
  std::string waits_for() const override { return {}; }
};

/// All of them, in the order of fasttree_top's `activity`: that of the model as well.
std::vector<std::unique_ptr<RecordedUnit>> recorded_units(const model::PaperConfig& config);

}  // namespace fasttree::rtl
