// SPDX-License-Identifier: Apache-2.0
#include "render/legend.h"

#include <algorithm>
#include <cmath>

#include "render/colour.h"
#include "render/text.h"

namespace fasttree::render {

void draw_legend(Image& image, const std::string& caption, const std::vector<LegendMark>& marks) {
  if (image.width < kLegendMinSize || image.height < kLegendMinSize) return;
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  const int scale = std::max(1, std::min(width, height) / 400);
  const int line = kTextLine * scale, margin = 8 * scale;
  const int bar_height = 8 * scale;
  const int top = height - (2 * line + bar_height + margin);
  const Double3 paper = from_srgb(16, 16, 20), ink = from_srgb(235, 235, 235);
  for (int y = top; y < height; ++y)
    for (int x = 0; x < width; ++x)
      set_pixel(image, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), paper);

  const int bar_left = margin, bar_width = width - 2 * margin, bar_top = top + line + 2 * scale;
  for (int x = 0; x < bar_width; ++x) {
    const Double3 colour = colour_scale((x + 0.5) / bar_width);
    for (int y = 0; y < bar_height; ++y)
      set_pixel(image, static_cast<std::uint32_t>(bar_left + x),
                static_cast<std::uint32_t>(bar_top + y), colour);
  }
  draw_text(image, margin, top + 3 * scale, scale, caption, ink);
  int free_from = 0;
  for (const LegendMark& mark : marks) {
    const int text = text_width(mark.text, scale);
    int x = bar_left + static_cast<int>(std::lround(mark.place * bar_width)) - text / 2;
    x = std::clamp(x, bar_left, std::max(bar_left, bar_left + bar_width - text));
    if (x < free_from) continue;  // no room beside the mark before
    draw_text(image, x, bar_top + bar_height + 3 * scale, scale, mark.text, ink);
    free_from = x + text + 6 * scale;
  }
}

std::string short_number(double value) {
  const char* unit = "";
  if (value >= 999'500) {
    value /= 1e6;
    unit = "M";
  } else if (value >= 9'995) {
    value /= 1e3;
    unit = "k";
  }
  const bool whole = value >= 99.95 || value == std::floor(value);
  const auto tenths = static_cast<long long>(std::llround(value * 10));
  std::string text = std::to_string(whole ? std::llround(value) : tenths / 10);
  if (!whole) {
    text += '.';
    text += std::to_string(tenths % 10);
  }
  text += unit;
  return text;
}

}  // namespace fasttree::render
