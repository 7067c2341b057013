// SPDX-License-Identifier: Apache-2.0
#include "scene/procedural/shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fasttree::scene {

Patch quad(Point a, Point b, Point c, Point d, std::uint32_t nu, std::uint32_t nv) {
  return {[=](double u, double v) { return lerp(lerp(a, b, u), lerp(d, c, u), v); }, nu, nv};
}

Patch ruled(Curve lower, Curve upper, std::uint32_t nu, std::uint32_t nv) {
  return {[lower = std::move(lower), upper = std::move(upper)](double u, double v) {
            return lerp(lower(u), upper(u), v);
          },
          nu, nv};
}

void add_box(Plan& plan, Point lo, Point hi, bool bottom) {
  const auto corner = [&](int i) {
    return Point{(i & 1) != 0 ? hi.x : lo.x, (i & 2) != 0 ? hi.y : lo.y,
                 (i & 4) != 0 ? hi.z : lo.z};
  };
  const auto face = [&](int a, int b, int c, int d) {
    plan.add(quad(corner(a), corner(b), corner(c), corner(d)));
  };
  face(4, 5, 7, 6);  // front, +z
  face(1, 0, 2, 3);  // back
  face(5, 1, 3, 7);  // right, +x
  face(0, 4, 6, 2);  // left
  face(6, 7, 3, 2);  // top
  if (bottom) face(0, 1, 5, 4);
}

Patch revolved(Point foot, std::function<Point(double)> profile) {
  Patch patch;
  patch.at = [foot, profile = std::move(profile)](double u, double v) {
    const Point p = profile(v);
    const double angle = 2 * kPi * u;
    return foot + Point{p.x * std::sin(angle), p.y, p.x * std::cos(angle)};
  };
  patch.wrap_u = true;
  return patch;
}

Patch tube(Curve curve, double radius, Point reference) {
  Patch patch;
  patch.at = [curve = std::move(curve), radius, reference](double u, double v) {
    constexpr double kStep = 1e-4;
    const Point tangent = curve(std::min(u + kStep, 1.0)) - curve(std::max(u - kStep, 0.0));
    Point a = cross(reference, tangent);
    a = a * (1 / length(a));
    Point b = cross(tangent, a);
    b = b * (1 / length(b));
    const double angle = 2 * kPi * v;
    return curve(u) + (a * std::cos(angle) + b * std::sin(angle)) * radius;
  };
  patch.wrap_v = true;
  return patch;
}

Patch sphere(Point centre, double radius) {
  Patch patch = revolved(centre, [radius](double v) {
    return Point{radius * std::sin(kPi * v), -radius * std::cos(kPi * v), 0};
  });
  patch.pole_lo = patch.pole_hi = true;
  return patch;
}

Share knot_share(double weight) {
  Share share;
  share.weight = weight;
  share.aspect = 8;
  share.min_nu = 36;
  share.step_nv = kKnotStrands;
  return share;
}

Patch torus_knot(std::function<Point(Point)> place) {
  constexpr double kAround = 2, kThrough = 3;
  constexpr double kMajor = 0.56, kMinor = 0.25, kTube = 0.155;
  constexpr double kTwists = 7;
  Patch patch;
  patch.at = [place = std::move(place)](double u, double v) {
    // The curve lies on a torus, whose normal is a frame that needs no transport.
    const double t = 2 * kPi * u;
    const double cp = std::cos(kAround * t), sp = std::sin(kAround * t);
    const double cq = std::cos(kThrough * t), sq = std::sin(kThrough * t);
    const double ring = kMajor + kMinor * cq;
    const Point centre{ring * cp, ring * sp, kMinor * sq};
    const Point normal{cq * cp, cq * sp, sq};
    Point tangent{-kThrough * kMinor * sq * cp - kAround * ring * sp,
                  -kThrough * kMinor * sq * sp + kAround * ring * cp, kThrough * kMinor * cq};
    tangent = tangent * (1 / length(tangent));
    const Point side = cross(tangent, normal);
    // The strands run along u, so that the creases between them are edges of the mesh.
    const double a = 2 * kPi * v - kTwists * t;
    const double strand = std::abs(std::sin(kPi * kKnotStrands * v));
    const double radius = kTube * (0.74 + 0.26 * std::sqrt(1 - (1 - strand) * (1 - strand)));
    return place(centre + (normal * std::cos(a) + side * std::sin(a)) * radius);
  };
  patch.wrap_u = patch.wrap_v = true;
  return patch;
}

}  // namespace fasttree::scene
