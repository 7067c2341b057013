// SPDX-License-Identifier: Apache-2.0
#include "render/colour.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fasttree::render {

namespace {

std::uint8_t encode(double x) {
  x = std::clamp(x, 0.0, 1.0);
  const double s = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * s));
}

double decode(std::uint8_t byte) {
  const double s = byte / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

double roll_off(double x) {
  constexpr double kKnee = 0.7;
  return x <= kKnee ? x : kKnee + (1 - kKnee) * (1 - std::exp(-(x - kKnee) / (1 - kKnee)));
}

// Oklab to linear sRGB.
Double3 from_oklab(double lightness, double a, double b) {
  const auto cubed = [](double x) { return x * x * x; };
  const double l = cubed(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cubed(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cubed(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

}  // namespace

std::array<std::uint8_t, 3> to_srgb(Double3 linear) {
  return {encode(linear.x), encode(linear.y), encode(linear.z)};
}

Double3 from_srgb(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  return {decode(r), decode(g), decode(b)};
}

Double3 soft_shoulder(Double3 linear) {
  return {roll_off(linear.x), roll_off(linear.y), roll_off(linear.z)};
}

Double3 colour_scale(double value) {
  // Hue and chroma at even steps; lightness is a straight line.
  struct Stop {
    double hue_degrees, chroma;
  };
  constexpr std::array<Stop, 6> kStops{
      {{285, 0.05}, {305, 0.14}, {350, 0.17}, {392, 0.18}, {428, 0.148}, {465, 0.08}}};
  constexpr double kDark = 0.16, kLight = 0.97;
  const double t = std::isnan(value) ? 0.0 : std::clamp(value, 0.0, 1.0);
  const double place = t * (kStops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const double f = place - static_cast<double>(i);
  const double hue =
      (kStops[i].hue_degrees * (1 - f) + kStops[i + 1].hue_degrees * f) * std::numbers::pi / 180;
  const double chroma = kStops[i].chroma * (1 - f) + kStops[i + 1].chroma * f;
  return from_oklab(kDark + (kLight - kDark) * t, chroma * std::cos(hue), chroma * std::sin(hue));
}

}  // namespace fasttree::render
