// SPDX-License-Identifier: Apache-2.0
// From light to bytes, and the colour scale of the cost and tree pictures.
#pragma once

#include <array>
#include <cstdint>

#include "render/image.h"
#include "render/math.h"

namespace fasttree::render {

/// Linear light (1: white) to the bytes of sRGB (IEC 61966-2-1), clamped.
std::array<std::uint8_t, 3> to_srgb(Double3 linear);

/// The same backwards, for colours written as they are seen.
Double3 from_srgb(std::uint8_t r, std::uint8_t g, std::uint8_t b);

/// Rolls off what is brighter than about 0.7, so that highlights keep their shape.
Double3 soft_shoulder(Double3 linear);

/// A colour scale for 0 to 1, in linear light: dark violet, red, orange, pale yellow. Its lightness
/// grows evenly (Oklab, Ottosson 2020), so equal steps look equal, in grey too.
Double3 colour_scale(double value);

inline void set_pixel(Image& image, std::uint32_t x, std::uint32_t y, Double3 linear) {
  const auto bytes = to_srgb(linear);
  std::uint8_t* out = &image.rgb[3 * (std::size_t{y} * image.width + x)];
  for (std::size_t c = 0; c < 3; ++c) out[c] = bytes[c];
}

}  // namespace fasttree::render
