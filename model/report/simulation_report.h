// SPDX-License-Identifier: Apache-2.0
// A run with everything that its reports show beside the result itself.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/config/machine_config.h"
#include "model/report/cost_table.h"
#include "model/report/simulation.h"

namespace fasttree::model {

struct SimulationReport {
  std::string scene;
  MachineConfig config;
  std::string engine = "model";  ///< or "rtl"
  SimulationResult result;
  double wall_s = 0;  ///< that the simulation took
  /// Whether the run was compared with the reference builder, and the first difference.
  bool compared = false;
  std::string difference;  ///< empty: none
  /// Area, energy: what of it there is a model for.
  std::vector<CostTable> costs;
};

}  // namespace fasttree::model
