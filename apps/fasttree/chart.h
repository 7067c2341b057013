// SPDX-License-Identifier: Apache-2.0
// Bar charts as SVG.
#pragma once

#include <string>
#include <vector>

namespace fasttree::app {

/// One group of bars with a scale of its own.
struct ChartPanel {
  std::string title;  ///< with the unit, and which way is better
  struct Bar {
    std::string label;
    double value = 0;
    std::string text;  ///< what stands at the bar's end
  };
  std::vector<Bar> bars;
};

/// Panels below each other, bars from the left, each panel's longest bar as long as the others'.
std::string bar_chart_svg(const std::string& title, const std::vector<ChartPanel>& panels);

}  // namespace fasttree::app
