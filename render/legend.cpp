// SPDX-License-Identifier: Apache-2.0
#include "render/legend.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "render/colour.h"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#include <stb/stb_easy_font.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace fasttree::render {

namespace {

// The font makes rectangles: four vertices of x, y, z and a colour, 16 bytes each.
constexpr int kQuadFloats = 16;

// stb_easy_font wants its texts as char*, though it only reads them.
int text_width(std::string text, int scale) {
  return stb_easy_font_width(text.data()) * scale;
}

void draw_text(Image& image, int x, int y, int scale, std::string text, Double3 colour) {
  // A character has at most a dozen strokes.
  std::vector<float> quads(std::max<std::size_t>(text.size(), 1) * 24 * kQuadFloats);
  const int count = stb_easy_font_print(0, 0, text.data(), nullptr, quads.data(),
                                        static_cast<int>(quads.size() * sizeof(float)));
  for (int q = 0; q < count; ++q) {
    const float* v = &quads[static_cast<std::size_t>(q) * kQuadFloats];
    const int x0 = x + static_cast<int>(v[0]) * scale, y0 = y + static_cast<int>(v[1]) * scale;
    const int x1 = x + static_cast<int>(v[8]) * scale, y1 = y + static_cast<int>(v[9]) * scale;
    for (int py = std::max(y0, 0); py < std::min(y1, static_cast<int>(image.height)); ++py)
      for (int px = std::max(x0, 0); px < std::min(x1, static_cast<int>(image.width)); ++px)
        set_pixel(image, static_cast<std::uint32_t>(px), static_cast<std::uint32_t>(py), colour);
  }
}

}  // namespace

void draw_legend(Image& image, const std::string& caption, const std::vector<LegendMark>& marks) {
  if (image.width < kLegendMinSize || image.height < kLegendMinSize) return;
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  const int scale = std::max(1, std::min(width, height) / 400);
  const int line = 12 * scale, margin = 8 * scale;
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
