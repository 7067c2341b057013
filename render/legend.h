// SPDX-License-Identifier: Apache-2.0
// The colour bar with its numbers at the foot of a cost or tree picture.
#pragma once

#include <string>
#include <vector>

#include "render/image.h"

namespace fasttree::render {

/// A number under the bar, at a place from 0 (its left end) to 1.
struct LegendMark {
  double place;
  std::string text;
};

/// Pictures smaller than this on one side have no room for a legend.
inline constexpr std::uint32_t kLegendMinSize = 160;

/// Draws the colour scale over the lowest strip of the picture: caption, bar, marks.
void draw_legend(Image& image, const std::string& caption, const std::vector<LegendMark>& marks);

/// A number in few characters: 7, 85, 1.2k, 3.4M.
std::string short_number(double value);

}  // namespace fasttree::render
