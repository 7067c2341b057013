// SPDX-License-Identifier: Apache-2.0
// Figures written over a picture.
#pragma once

#include <string>
#include <vector>

#include "render/image.h"

namespace fasttree::live {

struct OverlayLine {
  std::string label;
  std::string value;    ///< stands at the right of its column; may be empty
  bool detail = false;  ///< a part of the line before: set in, and paler
};

/// Draws the lines on a darkened panel in the top left corner. What has no room is cut off.
void draw_overlay(render::Image& image, const std::vector<OverlayLine>& lines);

}  // namespace fasttree::live
