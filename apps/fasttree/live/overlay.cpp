// SPDX-License-Identifier: Apache-2.0
#include "live/overlay.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "render/colour.h"
#include "render/text.h"

namespace fasttree::live {

void draw_overlay(render::Image& image, const std::vector<OverlayLine>& lines) {
  if (lines.empty()) return;
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  const int scale = std::max(1, std::min(width, height) / 400);
  const int margin = 8 * scale, indent = 8 * scale, gap = 14 * scale;
  const int step = render::kTextLine * scale;
  int labels = 0, values = 0;
  for (const OverlayLine& line : lines) {
    labels = std::max(labels, render::text_width(line.label, scale) + (line.detail ? indent : 0));
    values = std::max(values, render::text_width(line.value, scale));
  }
  const int panel_width = std::min(width, labels + gap + values + 2 * margin);
  const int panel_height =
      std::min(height, static_cast<int>(lines.size()) * step + 2 * margin - 2 * scale);
  for (int y = 0; y < panel_height; ++y) {
    std::uint8_t* row = &image.rgb[3 * static_cast<std::size_t>(y) * image.width];
    for (int i = 0; i < 3 * panel_width; ++i) row[i] = static_cast<std::uint8_t>(row[i] / 4);
  }
  const render::Double3 ink = render::from_srgb(240, 240, 240);
  const render::Double3 pale = render::from_srgb(165, 175, 188);
  int y = margin;
  for (const OverlayLine& line : lines) {
    const render::Double3 colour = line.detail ? pale : ink;
    render::draw_text(image, margin + (line.detail ? indent : 0), y, scale, line.label, colour);
    const int right = margin + labels + gap + values;
    render::draw_text(image, right - render::text_width(line.value, scale), y, scale, line.value,
                      colour);
    y += step;
  }
}

}  // namespace fasttree::live
