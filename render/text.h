// SPDX-License-Identifier: Apache-2.0
// Text in pictures, in a small built-in font.
#pragma once

#include <string>

#include "render/image.h"
#include "render/math.h"

namespace fasttree::render {

/// Pixels from one line of text to the next at scale 1.
inline constexpr int kTextLine = 12;

/// Pixels that a line of ASCII takes from left to right. `scale` enlarges the font, 1 and up.
int text_width(std::string text, int scale);

/// Draws a line of ASCII with its top left corner at (x, y), in linear light. What lies outside of
/// the picture is left out.
void draw_text(Image& image, int x, int y, int scale, std::string text, Double3 colour);

}  // namespace fasttree::render
