// SPDX-License-Identifier: Apache-2.0
// Scenes that move: a loop in which every frame has the same triangles in the same order.
#include <algorithm>
#include <cmath>

#include "scene/procedural/random.h"
#include "scene/procedural/scenes.h"
#include "scene/procedural/shapes.h"

namespace fasttree::scene {

// Four Gerstner waves that all come back to where they were after one loop.
void plan_wave(const Request& request, Plan& plan) {
  Patch patch;
  patch.at = [phase = request.phase](double u, double v) {
    struct Wave {
      double kx, kz, height, turns;
    };
    constexpr Wave kWaves[] = {
        {1.1, 0.5, 0.20, 1}, {-0.7, 1.7, 0.12, 1}, {2.6, 1.9, 0.055, 2}, {3.9, -3.1, 0.028, 3}};
    Point p{4 * u - 2, 0, 2 - 4 * v};
    const Point rest = p;
    for (const Wave& w : kWaves) {
      const double k = std::hypot(w.kx, w.kz);
      const double angle = kPi * (w.kx * rest.x + w.kz * rest.z) - 2 * kPi * w.turns * phase;
      const double sideways = 0.5 * w.height * std::cos(angle) / k;
      p = p + Point{w.kx * sideways, w.height * std::sin(angle), w.kz * sideways};
    }
    return p;
  };
  plan.add(std::move(patch), Share{});
  plan.distribute(request.triangles);
}

// The knot falls apart into its triangles, which fly and turn, and comes together again.
void plan_breakup(const Request& request, Plan& plan) {
  Patch knot = torus_knot([](Point p) { return p; });
  set_resolution(knot, knot_share(1), static_cast<double>(request.triangles));
  const double nu = knot.nu, nv = knot.nv;
  const double apart = 0.5 - 0.5 * std::cos(2 * kPi * request.phase);

  Soup soup;
  soup.count = knot.triangles();
  soup.at = [=](std::uint64_t i) {
    constexpr std::uint64_t kStream = 0x627265616b;
    const auto columns = static_cast<std::uint64_t>(nu);
    const auto u = static_cast<double>(i / 2 % columns), v = static_cast<double>(i / 2 / columns);
    const auto corner = [&](double du, double dv) {
      return knot.at(std::fmod(u + du, nu) / nu, std::fmod(v + dv, nv) / nv);
    };
    std::array<Point, 3> corners = i % 2 == 0
                                       ? std::array{corner(0, 0), corner(1, 0), corner(1, 1)}
                                       : std::array{corner(0, 0), corner(1, 1), corner(0, 1)};
    const Point centre = (corners[0] + corners[1] + corners[2]) * (1.0 / 3);

    const auto random = [i](std::uint64_t k) { return uniform(kStream, 8 * i + k); };
    // A random direction in the ball, and away from the knot's middle.
    const Point flight =
        centre * 1.2 + Point{random(0) - 0.5, random(1) - 0.5, random(2) - 0.5} * 1.2;
    const double distance = apart * (0.3 + 1.2 * random(3) * random(3));
    const double height = 2 * random(4) - 1, around = 2 * kPi * random(5);
    const double spread = std::sqrt(1 - height * height);
    const Point axis{spread * std::cos(around), spread * std::sin(around), height};
    // Rodrigues' rotation about the axis through the triangle's centre.
    const double angle = apart * 4 * kPi * random(6);
    const double c = std::cos(angle), s = std::sin(angle);
    for (Point& p : corners) {
      const Point r = p - centre;
      const double along = (axis.x * r.x + axis.y * r.y + axis.z * r.z) * (1 - c);
      p = centre + flight * distance + r * c + cross(axis, r) * s + axis * along;
    }
    return corners;
  };
  plan.add(std::move(soup));
}

}  // namespace fasttree::scene
