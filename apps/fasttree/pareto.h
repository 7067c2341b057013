// SPDX-License-Identifier: Apache-2.0
// Which of several designs are worth a look, and a picture of them.
#pragma once

#include <string>
#include <vector>

namespace fasttree::app {

/// What a design costs by two measures, less being better by both.
struct Costs {
  double x = 0;
  double y = 0;
};

/// Whether each is on the front: nothing is at most as much by both measures and less by one.
std::vector<bool> pareto_front(const std::vector<Costs>& costs);

struct ParetoPanel {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<Costs> costs;  ///< a point
};

/// Panels beside each other. Points of the front are full and joined, the others are hollow; all
/// are labelled, by their number where there are many.
std::string pareto_svg(const std::string& title, const std::vector<std::string>& labels,
                       const std::vector<ParetoPanel>& panels);

}  // namespace fasttree::app
