// SPDX-License-Identifier: Apache-2.0
// The timeline as a Chrome trace (JSON), which Perfetto and chrome://tracing open.
#pragma once

#include <string>

#include "model/report/simulation_report.h"

namespace fasttree::model {

/// Time is the machine's, in microseconds. A track with the stages; a track a unit, with slices of
/// what it was mostly: busy or stalled, each with its cycles in args; counters for the share of
/// cycles that each unit was busy, and for the bandwidth in GB/s.
std::string timeline_json(const SimulationReport& report);

}  // namespace fasttree::model
