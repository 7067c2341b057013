// SPDX-License-Identifier: Apache-2.0
// Masonry for procedural buildings: walls with arched openings, tracery, groin vaults.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "scene/procedural/patch.h"

namespace fasttree::scene {

// A wall's own coordinates: s along it, y up, d into it.
using Wall = std::function<Point(double s, double y, double d)>;

// The height of half an ellipse over [-half, half].
inline double ellipse(double s, double half) {
  return std::sqrt(std::max(0.0, 1 - s * s / (half * half)));
}

// An opening with a round arch.
struct Opening {
  double sill, half, spring, rise, depth;
};

// How far walls reach up behind a vault, which is divided otherwise: no light comes in between.
inline constexpr double kOverlap = 0.06;

// The detail of the parts that grow with the asked number of triangles.
inline Share share(double weight, double aspect, std::uint32_t min_nu, std::uint32_t min_nv) {
  return {weight, aspect, min_nu, min_nv};
}

// A wall over s from -half to half, between `floor` and `top(s)`, with an opening and its reveal.
// `bend` is how many pieces a straight line in s takes (more than 1 where the wall is curved).
void add_wall(Plan& plan, const Wall& wall, double half, double floor,
              const std::function<double(double)>& top, const Opening& o, std::uint32_t bend);

// A mullion, a bar across and a ring in the arch.
void add_tracery(Plan& plan, const Wall& wall, const Opening& o);

// A groin vault over a rectangle: the higher of two elliptical barrels. Eight pieces with the
// creases as their edges, then ribs along the creases and a boss at the crown.
void add_vault(Plan& plan, Point centre, double half_x, double half_z, double rise, double weight);

}  // namespace fasttree::scene
