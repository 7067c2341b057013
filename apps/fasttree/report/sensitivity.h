// SPDX-License-Identifier: Apache-2.0
// What each assumption about a machine is worth: it is changed, the machine simulated again.
#pragma once

#include <string>
#include <vector>

#include "command.h"
#include "exploration.h"

namespace fasttree::app {

struct KeyChange {
  std::string key;      ///< "paper.bus_bytes_per_cycle"
  std::string base;     ///< what it holds
  std::string value;    ///< what it was changed to
  std::string meaning;  ///< its comment
  double time_percent = 0, area_percent = 0, energy_percent = 0;
};

struct Sensitivity {
  std::string config;
  std::string scene;
  ExploredRun base;
  std::vector<KeyChange> changes;    ///< the largest change of time first
  std::vector<std::string> refused;  ///< "key=value: why"
};

/// Every assumption of the machine, one at a time; for the paper's machine also what it states or
/// leaves to others and is often asked about: clock, memory timing, mark cache, number of units.
Sensitivity sensitivity_of(Context& context, const DesignPoint& machine,
                           const std::vector<ExploredScene>& scene, std::uint64_t memory_bytes);

}  // namespace fasttree::app
