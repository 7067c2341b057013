// SPDX-License-Identifier: Apache-2.0
// Line plots as SVG.
#pragma once

#include <string>
#include <vector>

namespace fasttree::app {

struct PlotLine {
  std::string label;
  std::vector<double> values;  ///< of x = 0, 1, 2, ...
};

/// Lines over whole numbers, with axes that begin at 0 and a legend.
std::string line_plot_svg(const std::string& title, const std::string& x_label,
                          const std::string& y_label, const std::vector<PlotLine>& lines);

}  // namespace fasttree::app
