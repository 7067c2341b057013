// SPDX-License-Identifier: Apache-2.0
#include "render/colour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/legend.h"

namespace fasttree::render {
namespace {

TEST(Colour, SrgbBothWays) {
  for (int i = 0; i < 256; ++i) {
    const auto byte = static_cast<std::uint8_t>(i);
    const auto back = to_srgb(from_srgb(byte, 0, 255));
    EXPECT_EQ(back[0], byte);
    EXPECT_EQ(back[1], 0);
    EXPECT_EQ(back[2], 255);
  }
  EXPECT_EQ(to_srgb({0.5, 2.0, -1.0}), (std::array<std::uint8_t, 3>{188, 255, 0}));
}

// Relative luminance, then the lightness of CIE Lab: what the eye calls even.
double lightness(Double3 c) {
  const double y = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
  return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

TEST(Colour, ScaleGrowsEvenlyAndStaysInGamut) {
  constexpr int kSteps = 100;
  double last = lightness(colour_scale(0));
  const double whole = lightness(colour_scale(1)) - last;
  EXPECT_GT(whole, 80);
  for (int i = 1; i <= kSteps; ++i) {
    const Double3 c = colour_scale(static_cast<double>(i) / kSteps);
    for (const double channel : {c.x, c.y, c.z}) {
      EXPECT_GT(channel, -0.01) << i;
      EXPECT_LT(channel, 1.01) << i;
    }
    const double now = lightness(c);
    EXPECT_GT(now - last, 0.3 * whole / kSteps) << i;
    EXPECT_LT(now - last, 2.0 * whole / kSteps) << i;
    last = now;
  }
  EXPECT_EQ(to_srgb(colour_scale(-5)), to_srgb(colour_scale(0)));
  EXPECT_EQ(to_srgb(colour_scale(5)), to_srgb(colour_scale(1)));
  EXPECT_EQ(to_srgb(colour_scale(std::numeric_limits<double>::quiet_NaN())),
            to_srgb(colour_scale(0)));
}

TEST(Legend, ShortNumbers) {
  EXPECT_EQ(short_number(0), "0");
  EXPECT_EQ(short_number(7), "7");
  EXPECT_EQ(short_number(63.14), "63.1");
  EXPECT_EQ(short_number(9.96), "10.0");
  EXPECT_EQ(short_number(100), "100");
  EXPECT_EQ(short_number(1234), "1234");
  EXPECT_EQ(short_number(12345), "12.3k");
  EXPECT_EQ(short_number(999'499), "999k");
  EXPECT_EQ(short_number(1e6), "1M");
  EXPECT_EQ(short_number(3.4e6), "3.4M");
}

TEST(Legend, StaysInItsStrip) {
  for (const auto& [width, height] : {std::pair{160u, 160u}, {300u, 900u}, {2000u, 1000u}}) {
    Image image{width, height, std::vector<std::uint8_t>(std::size_t{3} * width * height, 77)};
    draw_legend(image, std::string(500, 'W'), {{0, "0"}, {0.5, std::string(300, '8')}, {1, "9"}});
    std::size_t changed_rows = 0;
    for (std::uint32_t y = 0; y < height; ++y) {
      bool changed = false;
      for (std::uint32_t i = 0; i < 3 * width; ++i)
        changed |= image.rgb[std::size_t{3} * width * y + i] != 77;
      changed_rows += changed ? 1 : 0;
      EXPECT_TRUE(!changed || y > height / 2);
    }
    EXPECT_GT(changed_rows, 20u);
  }
  Image tiny{100, 100, std::vector<std::uint8_t>(30000, 77)};
  const Image before = tiny;
  draw_legend(tiny, "no room", {{0, "0"}});
  EXPECT_EQ(tiny, before);
}

}  // namespace
}  // namespace fasttree::render
