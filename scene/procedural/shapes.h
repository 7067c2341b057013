// SPDX-License-Identifier: Apache-2.0
// Patches that several scenes are put together from.
#pragma once

#include <functional>

#include "scene/procedural/patch.h"

namespace fasttree::scene {

using Curve = std::function<Point(double)>;

/// The flat (or bilinear) patch a, b, c, d, counterclockwise as seen from its front.
Patch quad(Point a, Point b, Point c, Point d, std::uint32_t nu = 1, std::uint32_t nv = 1);

/// Straight lines from `lower(u)` to `upper(u)`.
Patch ruled(Curve lower, Curve upper, std::uint32_t nu = 1, std::uint32_t nv = 1);

/// Sides and top of a box; its bottom too where asked.
void add_box(Plan& plan, Point lo, Point hi, bool bottom = false);

/// A profile (radius in x, height in y, for v from 0 to 1) turned about the y axis through `foot`.
Patch revolved(Point foot, std::function<Point(double)> profile);

/// A round tube along an open curve that never runs along `reference`.
Patch tube(Curve curve, double radius, Point reference);

/// A sphere, poles on the y axis.
Patch sphere(Point centre, double radius);

/// A rope of six strands tied into a torus knot that winds twice around and three times through.
/// The knot fits a sphere of radius 1 about the origin; `place` moves it. Its axis is z.
Patch torus_knot(std::function<Point(Point)> place);

inline constexpr std::uint32_t kKnotStrands = 6;

/// How a knot wants to be divided.
Share knot_share(double weight);

}  // namespace fasttree::scene
