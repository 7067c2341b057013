// SPDX-License-Identifier: Apache-2.0
#include "scene/procedural/masonry.h"

#include <utility>

#include "scene/procedural/shapes.h"

namespace fasttree::scene {

void add_wall(Plan& plan, const Wall& wall, double half, double floor,
              const std::function<double(double)>& top, const Opening& o, std::uint32_t bend) {
  for (const double side : {-1.0, 1.0}) {
    const auto s = [=](double u) { return side * (o.half + (half - o.half) * u); };
    plan.add(ruled([=](double u) { return wall(s(u), floor, 0); },
                   [=](double u) { return wall(s(u), top(s(u)), 0); }, 6 * bend, 1));
    plan.add(ruled(
        [=](double u) { return wall(side * o.half, o.sill + (o.spring - o.sill) * u, 0); },
        [=](double u) { return wall(side * o.half, o.sill + (o.spring - o.sill) * u, o.depth); }));
  }
  const auto across = [=](double u) { return o.half * (2 * u - 1); };
  if (o.sill > floor) {
    plan.add(ruled([=](double u) { return wall(across(u), floor, 0); },
                   [=](double u) { return wall(across(u), o.sill, 0); }, bend, 1));
    plan.add(ruled([=](double u) { return wall(across(u), o.sill, 0); },
                   [=](double u) { return wall(across(u), o.sill, o.depth); }, bend, 1));
  }
  const auto arch_s = [=](double u) { return -o.half * std::cos(kPi * u); };
  const auto arch = [=](double u, double d) {
    return wall(arch_s(u), o.spring + o.rise * std::sin(kPi * u), d);
  };
  plan.add(ruled([=](double u) { return arch(u, 0); },
                 [=](double u) { return wall(arch_s(u), top(arch_s(u)), 0); }, 24, 1));
  plan.add(ruled([=](double u) { return arch(u, 0); }, [=](double u) { return arch(u, o.depth); },
                 24, 1));
}

void add_tracery(Plan& plan, const Wall& wall, const Opening& o) {
  const double d = 0.6 * o.depth, r = 0.05;
  const auto bar = [&](double s0, double y0, double s1, double y1) {
    Patch patch = tube([=](double u) { return wall(s0 + (s1 - s0) * u, y0 + (y1 - y0) * u, d); }, r,
                       wall(0, 0, 1) - wall(0, 0, 0));
    plan.add(std::move(patch), share(0.2, 0.2, 1, 4));
  };
  bar(0, o.sill, 0, o.spring);
  bar(-o.half, o.spring, o.half, o.spring);
  Patch ring;
  ring.at = [=](double u, double v) {
    const double a = 2 * kPi * u, b = 2 * kPi * v;
    const double radius = 0.42 * o.rise + r * std::cos(b);
    return wall(radius * std::cos(a), o.spring + 0.47 * o.rise + radius * std::sin(a),
                d + r * std::sin(b));
  };
  ring.wrap_u = ring.wrap_v = true;
  plan.add(std::move(ring), share(0.4, 6, 8, 3));
}

void add_vault(Plan& plan, Point centre, double half_x, double half_z, double rise, double weight) {
  for (int piece = 0; piece < 8; ++piece) {
    const double sx = (piece & 1) != 0 ? -1 : 1, sz = (piece & 2) != 0 ? -1 : 1;
    const bool along_x = (piece & 4) != 0;
    Patch patch;
    patch.at = [=](double u, double v) {
      // `narrow` decides the height; `wide` runs from the crease to the edge of the rectangle.
      const double narrow = std::sin(0.5 * kPi * v);
      const double wide = narrow + (1 - narrow) * u;
      const double x = along_x ? wide : narrow, z = along_x ? narrow : wide;
      return centre + Point{sx * half_x * x, rise * std::cos(0.5 * kPi * v), sz * half_z * z};
    };
    patch.pole_hi = true;
    plan.add(std::move(patch), share(weight, 0.5, 1, 4));
  }
  for (const double side : {-1.0, 1.0}) {
    Patch rib = tube(
        [=](double u) {
          const double a = kPi * u, s = -std::cos(a);
          return centre + Point{half_x * s, rise * std::sin(a) - 0.02, side * half_z * s};
        },
        0.11, {-half_z, 0, side * half_x});
    plan.add(std::move(rib), share(1.5 * weight, 5, 12, 4));
  }
  plan.add(sphere(centre + Point{0, rise - 0.05, 0}, 0.3), share(0.5 * weight, 1.5, 6, 3));
}

}  // namespace fasttree::scene
