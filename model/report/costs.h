// SPDX-License-Identifier: Apache-2.0
// Area and energy of a run as tables for its reports.
#pragma once

#include <vector>

#include "model/report/simulation_report.h"

namespace fasttree::model {

/// Area by unit, and energy by unit and in memory.
std::vector<CostTable> cost_tables(const MachineConfig& config, const SimulationResult& result);

}  // namespace fasttree::model
