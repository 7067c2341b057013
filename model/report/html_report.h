// SPDX-License-Identifier: Apache-2.0
// A report as one HTML page that needs nothing but itself.
#pragma once

#include <string>

#include "model/report/simulation_report.h"

namespace fasttree::model {

std::string html_report(const SimulationReport& report);

}  // namespace fasttree::model
