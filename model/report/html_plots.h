// SPDX-License-Identifier: Apache-2.0
// The plots of the HTML report: pictures that stretch with the page (inline SVG without text) and
// labels that do not (HTML beside them), so that they can be read at any width.
#pragma once

#include <string>
#include <vector>

#include "model/report/simulation_report.h"

namespace fasttree::model {

/// The class (see html_style.h) that colours a stage wherever it is shown.
std::string stage_class(std::size_t stage);

/// The stages side by side, each as long as it took.
std::string stage_bar(const SimulationResult& result);

/// A row a unit: the share of cycles in which it was busy, and stalled on top of that, over time.
std::string occupancy_plot(const SimulationResult& result);

/// Bytes over the bus a second over time, against what memory and bus can do at most.
std::string bandwidth_plot(const SimulationReport& report);

/// Reads by latency.
std::string latency_plot(const MemoryStatistics& memory);

}  // namespace fasttree::model
