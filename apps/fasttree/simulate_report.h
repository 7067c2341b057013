// SPDX-License-Identifier: Apache-2.0
// What fasttree simulate says on the terminal.
#pragma once

#include "model/report/simulation_report.h"
#include "output.h"

namespace fasttree::app {

void print_simulation(Output& output, const model::SimulationReport& report);

}  // namespace fasttree::app
