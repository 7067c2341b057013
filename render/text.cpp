// SPDX-License-Identifier: Apache-2.0
#include "render/text.h"

#include <algorithm>
#include <cstring>
#include <vector>

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

}  // namespace

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

}  // namespace fasttree::render
