// SPDX-License-Identifier: Apache-2.0
// Samples from a hash of the pixel and the sample's number: the same whichever thread draws them.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "render/math.h"

namespace fasttree::render {

/// What a sample decides; each purpose gets numbers of its own.
enum class Purpose : std::uint32_t { pixel = 1, light = 2, occlusion = 3 };

struct Sample2 {
  double u, v;
};

/// The finaliser of MurmurHash3.
inline std::uint32_t hash32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x85ebca6bu;
  x ^= x >> 13;
  x *= 0xc2b2ae35u;
  return x ^ (x >> 16);
}

/// Point `index` of a sequence in [0, 1)^2 that fills the square evenly (the additive recurrence
/// R2, Roberts 2018), shifted by an amount of the pixel's own (Cranley and Patterson 1976).
inline Sample2 sample(std::uint32_t x, std::uint32_t y, Purpose purpose, std::uint32_t index) {
  // 1 / p and 1 / p^2 for the real root p of p^3 = p + 1, in units of 2^-32.
  constexpr std::uint32_t kStepU = 3242174889u, kStepV = 2447445414u;
  const std::uint32_t seed = hash32(x ^ hash32(y ^ hash32(static_cast<std::uint32_t>(purpose))));
  const std::uint32_t u = seed + kStepU * index;
  const std::uint32_t v = hash32(seed + 0x9e3779b9u) + kStepV * index;
  return {u * 0x1p-32, v * 0x1p-32};
}

/// A direction about +z with density cosine / pi.
inline Double3 cosine_hemisphere(Sample2 s) {
  const double radius = std::sqrt(s.u), angle = 2 * std::numbers::pi * s.v;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - s.u)};
}

/// A point of the unit disc's area.
inline Sample2 disc(Sample2 s) {
  const double radius = std::sqrt(s.u), angle = 2 * std::numbers::pi * s.v;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Direction i of n, spread evenly over the sphere (a Fibonacci spiral).
inline Double3 spiral_direction(std::uint32_t i, std::uint32_t n) {
  const double y = 1 - (2.0 * i + 1) / n;
  const double radius = std::sqrt(1 - y * y);
  const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
  return {radius * std::cos(angle), y, radius * std::sin(angle)};
}

}  // namespace fasttree::render
