// SPDX-License-Identifier: Apache-2.0
// A report as JSON. Units are in the names of the keys.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "model/report/simulation_report.h"

namespace fasttree::model {

/// docs/accelerator/simulate.md lists the keys.
nlohmann::ordered_json report_json(const SimulationReport& report);

}  // namespace fasttree::model
