// SPDX-License-Identifier: Apache-2.0
// A report as CSV: one row a stage and unit.
#pragma once

#include <string>

#include "model/report/simulation_report.h"

namespace fasttree::model {

/// Columns: scene, config, stage, unit, kind, stage_cycles, busy_cycles, stalled_cycles,
/// idle_cycles, stalled_on ("bus 120; prefix_sum 7": cycles by reason, the longest first).
std::string report_csv(const SimulationReport& report);

}  // namespace fasttree::model
