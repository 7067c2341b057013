// SPDX-License-Identifier: Apache-2.0
// Scenes of one object: knot, sphere flake, cloud, terrain.
#include <cmath>

#include "scene/procedural/random.h"
#include "scene/procedural/scenes.h"
#include "scene/procedural/shapes.h"

namespace fasttree::scene {

void plan_knot(const Request& request, Plan& plan) {
  plan.add(torus_knot([](Point p) { return p; }), knot_share(1));
  plan.distribute(request.triangles);
}

namespace {

// A sphere, nine of a third of its size on it (six around, three above, along `up`), and so on.
void add_flake(Plan& plan, Point centre, double radius, Point up, int level) {
  Share share;
  share.aspect = 1.5;
  share.min_nu = 3;
  plan.add(sphere(centre, radius), share);
  if (level == 0) return;
  const Point helper = std::abs(up.x) < 0.6 ? Point{1, 0, 0} : Point{0, 0, 1};
  Point a = cross(up, helper);
  a = a * (1 / length(a));
  const Point b = cross(up, a);
  for (int i = 0; i < 9; ++i) {
    const bool around = i < 6;
    const double angle = 2 * kPi * (around ? i / 6.0 : (i + 0.5) / 3.0);
    const double rise = around ? 0.0 : std::sqrt(2.0 / 3.0);
    const double spread = std::sqrt(1 - rise * rise);
    const Point direction =
        a * (spread * std::cos(angle)) + b * (spread * std::sin(angle)) + up * rise;
    add_flake(plan, centre + direction * (radius * 4 / 3), radius / 3, direction, level - 1);
  }
}

}  // namespace

void plan_spheres(const Request& request, Plan& plan) {
  // As deep as leaves some 60 triangles a sphere, 5 levels (66,430 spheres) at the most.
  int level = 0;
  for (std::uint64_t spheres = 10; level < 5 && spheres * 60 <= request.triangles; ++level)
    spheres = spheres * 9 + 1;
  add_flake(plan, {0, 0, 0}, 1.0, {0, 1, 0}, level);
  plan.distribute(request.triangles);
}

void plan_cloud(const Request& request, Plan& plan) {
  // Edges of about the mean distance between centres, so that neither the density of the cloud nor
  // the look of its surface depends on the number.
  const double size = 0.8 / std::cbrt(static_cast<double>(request.triangles));
  Soup soup;
  soup.count = request.triangles;
  soup.at = [size](std::uint64_t i) {
    constexpr std::uint64_t kStream = 0x636c6f7564;
    const auto random = [i](std::uint64_t k) { return uniform(kStream, 12 * i + k); };
    const Point centre{random(0), random(1), random(2)};
    std::array<Point, 3> corners;
    for (std::uint64_t c = 0; c < 3; ++c) {
      const Point offset{random(3 + 3 * c) - 0.5, random(4 + 3 * c) - 0.5, random(5 + 3 * c) - 0.5};
      corners[c] = centre + offset * (2 * size);
    }
    return corners;
  };
  plan.add(std::move(soup));
}

namespace {

double lattice(std::int64_t x, std::int64_t z, std::uint64_t octave) {
  const std::uint64_t cell =
      static_cast<std::uint64_t>(x) << 32 ^ (static_cast<std::uint64_t>(z) & 0xffffffffu);
  return uniform(0x7465727261 + octave, cell);
}

// Value noise with its slope: what ridges and erosion are made of.
struct Noise {
  double value, dx, dz;
};

Noise value_noise(double x, double z, std::uint64_t octave) {
  const double fx = std::floor(x), fz = std::floor(z);
  const auto ix = static_cast<std::int64_t>(fx), iz = static_cast<std::int64_t>(fz);
  const double u = x - fx, w = z - fz;
  const double su = u * u * u * (u * (6 * u - 15) + 10), sw = w * w * w * (w * (6 * w - 15) + 10);
  const double du = 30 * u * u * (u - 1) * (u - 1), dw = 30 * w * w * (w - 1) * (w - 1);
  const double a = lattice(ix, iz, octave), b = lattice(ix + 1, iz, octave);
  const double c = lattice(ix, iz + 1, octave), d = lattice(ix + 1, iz + 1, octave);
  const double k = a - b - c + d;
  return {a + (b - a) * su + (c - a) * sw + k * su * sw, du * (b - a + k * sw),
          dw * (c - a + k * su)};
}

// Octaves count less where the lower ones are steep: ridges stay sharp, valleys smooth.
double terrain_height(double x, double z) {
  double height = 0, amplitude = 0.5, slope_x = 0, slope_z = 0;
  for (std::uint64_t octave = 0; octave < 11; ++octave) {
    const Noise n = value_noise(x, z, octave);
    slope_x += n.dx;
    slope_z += n.dz;
    height += amplitude * n.value / (1 + slope_x * slope_x + slope_z * slope_z);
    amplitude *= 0.5;
    const double turned = 1.6 * x - 1.2 * z;
    z = 1.2 * x + 1.6 * z;
    x = turned;
  }
  return height;
}

}  // namespace

void plan_terrain(const Request& request, Plan& plan) {
  Patch patch;
  patch.at = [](double u, double v) {
    return Point{10 * u - 5, 3.4 * terrain_height(3.2 * u + 7.3, 3.2 * v + 2.1), 5 - 10 * v};
  };
  plan.add(std::move(patch), Share{});
  plan.distribute(request.triangles);
}

}  // namespace fasttree::scene
