// SPDX-License-Identifier: Apache-2.0
// A small dense object in a huge coarse room: the classic trap for builders that cut space without
// looking. The knot, one and a half metres high, stands in the middle of a stadium of 200 m.
#include <algorithm>
#include <cmath>

#include "scene/procedural/scenes.h"
#include "scene/procedural/shapes.h"

namespace fasttree::scene {

void plan_stadium(const Request& request, Plan& plan) {
  // At most a tenth of the triangles for the stadium: its rows get fewer and its oval coarser.
  const double budget = std::max(0.1 * static_cast<double>(request.triangles), 100.0);
  const double rows = std::clamp(std::floor(std::sqrt(budget / 32)), 2.0, 24.0);
  const double around = std::clamp(std::floor(budget / (4.5 * rows)), 8.0, 256.0);

  const auto oval = [](double angle, double r) {
    return Point{(60 + r) * std::sin(angle), 0, (40 + r) * std::cos(angle)};
  };
  Patch terraces;
  terraces.at = [=](double u, double v) {
    // Two quads a row: riser, then seat.
    const double k = std::round(2 * rows * v);
    const double riser = std::ceil(0.5 * k), seat = std::floor(0.5 * k);
    Point p = oval(2 * kPi * u, 40 * seat / rows);
    p.y = 1 + 22 * riser / rows;
    return p;
  };
  terraces.wrap_u = true;
  terraces.nu = static_cast<std::uint32_t>(around);
  terraces.nv = static_cast<std::uint32_t>(2 * rows);
  plan.add(std::move(terraces));

  Patch outside;
  outside.at = [=](double u, double v) {
    Point p = oval(2 * kPi * u, 40);
    p.y = 27 * v;
    return p;
  };
  outside.wrap_u = true;
  outside.nu = static_cast<std::uint32_t>(around);
  plan.add(std::move(outside));
  plan.add(quad({-100, 0, 80}, {100, 0, 80}, {100, 0, -80}, {-100, 0, -80}));

  add_box(plan, {-0.5, 0, -0.5}, {0.5, 0.8, 0.5});
  plan.add(torus_knot([](Point p) { return Point{0, 1.55, 0} + p * 0.75; }), knot_share(1));
  plan.distribute(request.triangles);
}

}  // namespace fasttree::scene
