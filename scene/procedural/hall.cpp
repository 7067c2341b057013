// SPDX-License-Identifier: Apache-2.0
// A vaulted hall: nave and two aisles of six bays, columns, arches, groin vaults with ribs,
// windows, tiles, and an apse with steps and a knot on a pedestal. Large triangles lie next to
// small ones, and the camera is meant to stand inside. Metres; y is up, the nave runs along z.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "scene/procedural/masonry.h"
#include "scene/procedural/random.h"
#include "scene/procedural/scenes.h"
#include "scene/procedural/shapes.h"

namespace fasttree::scene {

namespace {

constexpr int kBays = 6;
constexpr double kHalfBay = 3.0;
constexpr double kEnd = kBays * kHalfBay;  // the end walls are at z = -kEnd and kEnd
constexpr double kAxis = 5.0;              // the columns' axes are at x = -kAxis and kAxis
constexpr double kHalfWall = 0.45;         // half the thickness of the wall over the columns
constexpr double kNave = kAxis - kHalfWall;
constexpr double kAisleInner = kAxis + kHalfWall;
constexpr double kAisleOuter = 9.0;
constexpr double kCapital = 5.0;  // top of the columns, where arches and aisle vaults spring
constexpr double kCornice = 9.0;
constexpr double kSpring = 11.0;  // of the nave's vault
constexpr double kRise = 4.0;
constexpr double kAisleRise = 2.7;
constexpr double kOpening = 2.45;  // half the clear width between two columns
constexpr double kDais = 0.9;
constexpr double kApse = 4.0;
constexpr double kApseSpring = 8.0;

// A square-edged arch across the nave or an aisle, from (x0, y) to (x1, y) at z.
void add_transverse_arch(Plan& plan, double x0, double x1, double y, double rise, double z) {
  const double centre = 0.5 * (x0 + x1), half = 0.5 * (x1 - x0);
  const auto at = [=](double u, double depth, double dz) {
    const double a = kPi * u;
    return Point{centre - (half - depth) * std::cos(a), y + (rise - depth) * std::sin(a), z + dz};
  };
  constexpr double kDepth = 0.22, kHalf = 0.3;
  constexpr std::uint32_t kPieces = 32;
  for (const double side : {-kHalf, kHalf})
    plan.add(ruled([=](double u) { return at(u, kDepth, side); },
                   [=](double u) { return at(u, -0.05, side); }, kPieces, 1));
  plan.add(ruled([=](double u) { return at(u, kDepth, -kHalf); },
                 [=](double u) { return at(u, kDepth, kHalf); }, kPieces, 1));
}

void add_column(Plan& plan, double x, double z) {
  add_box(plan, {x - 0.62, 0, z - 0.62}, {x + 0.62, 0.28, z + 0.62});
  add_box(plan, {x - 0.62, kCapital - 0.28, z - 0.62}, {x + 0.62, kCapital, z + 0.62}, true);
  const Point foot{x, 0, z};
  Patch base = revolved(foot, [](double v) {
    return Point{0.45 + 0.07 * (1 - v) + 0.07 * std::abs(std::sin(3 * kPi * v)), 0.28 + 0.4 * v, 0};
  });
  plan.add(std::move(base), share(1.0, 3, 8, 6));

  constexpr double kFlutes = 16;
  Patch shaft;
  shaft.at = [=](double u, double v) {
    const double angle = 2 * kPi * u;
    const double ends = std::min(1.0, 12 * std::min(v, 1 - v));
    const double flute = 0.05 * std::abs(std::sin(0.5 * kFlutes * angle)) * ends;
    const double radius = 0.46 - 0.06 * v * v + flute - 0.05;
    return foot + Point{radius * std::sin(angle), 0.68 + 3.42 * v, radius * std::cos(angle)};
  };
  shaft.wrap_u = true;
  plan.add(std::move(shaft), share(4.0, 5, 8, 1));

  // The capital turns from a circle into a square, in two rows of leaves.
  Patch capital;
  capital.at = [=](double u, double v) {
    const double angle = 2 * kPi * u;
    const double c = std::cos(angle), s = std::sin(angle);
    const double square = 1 / std::max(std::abs(c), std::abs(s));
    const double leaf = 0.05 * std::sin(2 * kPi * v) * std::sin(2 * kPi * v) *
                        std::abs(std::cos(4 * angle + (v > 0.5 ? 0.5 * kPi : 0)));
    const double flare = v * v * v;
    const double radius = 0.38 + 0.04 * std::abs(std::cos(0.5 * kPi * std::min(1.0, 8 * v))) +
                          flare * (0.56 * square * flare + 0.5 * (1 - flare) - 0.38) + leaf;
    return foot + Point{radius * s, 4.1 + (kCapital - 0.28 - 4.1) * v, radius * c};
  };
  capital.wrap_u = true;
  plan.add(std::move(capital), share(3.0, 2.5, 8, 4));
}

// A thin shaft up the wall, from a column to the springing of the vault, and a bracket on top.
void add_wall_shaft(Plan& plan, double x, double z) {
  constexpr double kRadius = 0.2, kFoot = kCapital, kHead = kSpring - 0.35;
  Patch shaft = revolved({x, kFoot, z}, [](double v) {
    const double ring = std::max(0.0, 1 - 30 * std::min(v, 1 - v));
    return Point{kRadius * (1 + 0.35 * ring), (kHead - kFoot) * v, 0};
  });
  plan.add(std::move(shaft), share(1.0, 0.4, 6, 4));
  Patch bracket = revolved({x, kHead, z}, [](double v) {
    return Point{kRadius * 1.35 + 0.3 * v * v, 0.3 * v, 0};
  });
  plan.add(std::move(bracket), share(0.5, 4, 6, 2));
  add_box(plan, {x - 0.5, kSpring - 0.05, z - 0.5}, {x + 0.5, kSpring + 0.12, z + 0.5}, true);
}

// A small bracket on an aisle's outer wall, under the springing of its vault.
void add_bracket(Plan& plan, double x, double z) {
  Patch bracket = revolved({x, kCapital - 0.6, z}, [](double v) {
    return Point{0.05 + 0.4 * v * v, 0.6 * v, 0};
  });
  plan.add(std::move(bracket), share(0.5, 4, 6, 2));
  add_box(plan, {x - 0.5, kCapital, z - 0.5}, {x + 0.5, kCapital + 0.12, z + 0.5}, true);
}

// Arches from column to column, and the wall over them on both sides.
void add_arcade_bay(Plan& plan, double side, double z) {
  const auto place = [=](double x) {
    return [=](double s, double y, double d) { return Point{side * (x + d), y, z + s}; };
  };
  const Opening arch{kCapital, kOpening, kCapital, kOpening, 2 * kHalfWall};
  add_wall(
      plan, place(kNave), kHalfBay, kCapital, [](double) { return kCornice; }, arch, 1);
  const auto vault = [](double s) {
    return kCapital + kOverlap + kAisleRise * ellipse(s, kHalfBay);
  };
  const Wall aisle = place(kAisleInner);
  for (const double end : {-1.0, 1.0}) {
    const auto s = [=](double u) { return end * (kOpening + (kHalfBay - kOpening) * u); };
    plan.add(ruled([=](double u) { return aisle(s(u), kCapital, 0); },
                   [=](double u) { return aisle(s(u), vault(s(u)), 0); }, 4, 1));
  }
  const auto s = [](double u) { return -kOpening * std::cos(kPi * u); };
  plan.add(ruled([=](double u) { return aisle(s(u), kCapital + kOpening * std::sin(kPi * u), 0); },
                 [=](double u) { return aisle(s(u), vault(s(u)), 0); }, 24, 1));
  for (const double x : {kNave, kAisleInner}) {
    Patch roll = tube(
        [=](double u) {
          const double a = kPi * u;
          return Point{side * x, kCapital + kOpening * std::sin(a), z - kOpening * std::cos(a)};
        },
        0.09, {1, 0, 0});
    plan.add(std::move(roll), share(1.5, 5, 12, 4));
  }
  const Opening window{10.1, 1.1, 12.0, 1.1, 0.5};
  const Wall clerestory = place(kNave);
  add_wall(
      plan, clerestory, kHalfBay, kCornice,
      [](double t) { return kSpring + kOverlap + kRise * ellipse(t, kHalfBay); }, window, 1);
  add_tracery(plan, clerestory, window);

  const Opening low{1.8, 0.85, 4.2, 0.85, 0.6};
  const Wall outer = place(kAisleOuter);
  add_wall(plan, outer, kHalfBay, 0, vault, low, 1);
  add_tracery(plan, outer, low);
}

// An S-shaped profile along the whole nave: triangles 36 m long and some centimetres wide.
void add_cornice(Plan& plan, double side) {
  Patch patch;
  patch.at = [=](double u, double v) {
    const double out = 0.30 * v + 0.06 * std::sin(2 * kPi * v);
    return Point{side * (kNave - (v < 1 ? out : 0)), kCornice - 0.15 + 0.4 * std::min(v, 0.9) / 0.9,
                 kEnd * (2 * u - 1)};
  };
  patch.nv = 10;
  plan.add(std::move(patch));
}

// Tiles with worn edges, none quite level: ten triangles each, the top's two and a bevel's eight.
void add_floor(Plan& plan, std::uint64_t triangles) {
  constexpr double kWidth = 2 * kAisleOuter, kLength = 2 * kEnd;
  const double count = std::clamp(static_cast<double>(triangles) * 0.10 / 10, 8.0, 20000.0);
  const auto nx = static_cast<std::uint64_t>(std::sqrt(count * kWidth / kLength));
  const auto nz = 2 * nx;
  const double size_x = kWidth / static_cast<double>(nx);
  const double size_z = kLength / static_cast<double>(nz);
  const double bevel = 0.02 * std::min(size_x, size_z), drop = 0.6 * bevel;
  Soup tiles;
  tiles.count = 10 * nx * nz;
  tiles.at = [=](std::uint64_t triangle) {
    constexpr std::uint64_t kStream = 0x74696c65;
    const std::uint64_t tile = triangle / 10, part = triangle % 10 / 2;
    const Point lo{static_cast<double>(tile % nx) * size_x - kAisleOuter, -drop,
                   static_cast<double>(tile / nx) * size_z - kEnd};
    const Point hi{lo.x + size_x, 0, lo.z + size_z};
    const auto level = [=](std::uint64_t k) {
      return 0.3 * drop * (uniform(kStream, 4 * tile + k) - 0.5);
    };
    const std::array<Point, 4> outer{
        {{lo.x, lo.y, hi.z}, {hi.x, lo.y, hi.z}, {hi.x, lo.y, lo.z}, lo}};
    const std::array<Point, 4> inner{{{lo.x + bevel, level(0), hi.z - bevel},
                                      {hi.x - bevel, level(1), hi.z - bevel},
                                      {hi.x - bevel, level(2), lo.z + bevel},
                                      {lo.x + bevel, level(3), lo.z + bevel}}};
    const std::uint64_t k = part % 4, next = (k + 1) % 4;
    const std::array<Point, 4> face =
        part == 4 ? inner : std::array<Point, 4>{outer[k], outer[next], inner[next], inner[k]};
    return triangle % 2 == 0 ? std::array<Point, 3>{face[0], face[1], face[2]}
                             : std::array<Point, 3>{face[0], face[2], face[3]};
  };
  plan.add(std::move(tiles));
}

void add_apse(Plan& plan) {
  for (int step = 0; step < 5; ++step) {
    const double y = kDais * (step + 1) / 5;
    add_box(plan, {-kNave, 0, -kEnd}, {kNave, y, -10.5 - 0.42 * step});
  }
  plan.add(ruled(
      [](double u) {
        return Point{kApse * (2 * u - 1), kDais, -kEnd};
      },
      [](double u) {
        const double a = kPi * u;
        return Point{-kApse * std::cos(a), kDais, -kEnd - kApse * std::sin(a)};
      },
      24, 1));
  // Three windows in the half cylinder, each over a third of it.
  for (int bay = 0; bay < 3; ++bay) {
    const double middle = kPi * (bay + 0.5) / 3;
    const Wall wall = [=](double s, double y, double d) {
      const double a = middle + s / kApse, r = kApse + d;
      return Point{-r * std::cos(a), y, -kEnd - r * std::sin(a)};
    };
    const Opening window{2.6, 0.7, 6.0, 0.7, 0.5};
    add_wall(
        plan, wall, kApse * kPi / 6, kDais, [](double) { return kApseSpring; }, window, 4);
    add_tracery(plan, wall, window);
  }
  Patch dome;
  dome.at = [](double u, double v) {
    const double a = kPi * u, b = 0.5 * kPi * v, r = kApse * std::cos(b);
    return Point{-r * std::cos(a), kApseSpring + kApse * std::sin(b), -kEnd - r * std::sin(a)};
  };
  dome.pole_hi = true;
  plan.add(std::move(dome), share(20, 2, 12, 6));

  constexpr double kMiddle = -kEnd - 0.6;
  add_box(plan, {-0.75, kDais, kMiddle - 0.75}, {0.75, kDais + 0.25, kMiddle + 0.75});
  add_box(plan, {-0.6, kDais + 0.25, kMiddle - 0.6}, {0.6, kDais + 1.5, kMiddle + 0.6});
  plan.add(torus_knot([](Point p) {
             return Point{0, kDais + 1.5 + 1.6, kMiddle} + p * 1.7;
           }),
           knot_share(250));
}

// The walls at both ends: the nave's, with the apse's arch or the great window, and the aisles'.
void add_ends(Plan& plan) {
  const auto nave_top = [](double s) { return kSpring + kOverlap + kRise * ellipse(s, kNave); };
  const Wall back = [](double s, double y, double d) { return Point{s, y, -kEnd - d}; };
  const Opening apse{kDais, kApse, kApseSpring, kApse, 0.0};
  add_wall(plan, back, kNave, kDais, nave_top, apse, 1);
  const Wall front = [](double s, double y, double d) { return Point{s, y, kEnd + d}; };
  const Opening great{6.5, 1.3, 10.0, 1.3, 0.6};
  add_wall(plan, front, kNave, 0, nave_top, great, 1);
  add_tracery(plan, front, great);
  constexpr double kMiddle = 0.5 * (kAisleInner + kAisleOuter);
  constexpr double kHalf = 0.5 * (kAisleOuter - kAisleInner);
  for (const double side : {-1.0, 1.0}) {
    for (const double z : {-kEnd, kEnd}) {
      plan.add(ruled(
          [=](double u) {
            return Point{side * (kMiddle + kHalf * (2 * u - 1)), 0, z};
          },
          [=](double u) {
            const double s = kHalf * (2 * u - 1);
            return Point{side * (kMiddle + s), kCapital + kOverlap + kAisleRise * ellipse(s, kHalf),
                         z};
          },
          24, 1));
    }
  }
}

}  // namespace

void plan_hall(const Request& request, Plan& plan) {
  add_floor(plan, request.triangles);
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i <= kBays; ++i) {
      const double z = 2 * kHalfBay * i - kEnd;
      add_column(plan, side * kAxis, z);
      add_wall_shaft(plan, side * kNave, z);
      add_bracket(plan, side * kAisleOuter, z);
    }
    add_cornice(plan, side);
    for (int i = 0; i < kBays; ++i) {
      const double z = 2 * kHalfBay * i + kHalfBay - kEnd;
      add_arcade_bay(plan, side, z);
      add_vault(plan, {side * 0.5 * (kAisleInner + kAisleOuter), kCapital, z},
                0.5 * (kAisleOuter - kAisleInner), kHalfBay, kAisleRise, 1.0);
    }
    for (int i = 0; i <= kBays; ++i) {
      const double a = side * kAisleInner, b = side * kAisleOuter;
      add_transverse_arch(plan, std::min(a, b), std::max(a, b), kCapital, kAisleRise,
                          2 * kHalfBay * i - kEnd);
    }
  }
  for (int i = 0; i < kBays; ++i)
    add_vault(plan, {0, kSpring, 2 * kHalfBay * i + kHalfBay - kEnd}, kNave, kHalfBay, kRise, 2.5);
  for (int i = 0; i <= kBays; ++i)
    add_transverse_arch(plan, -kNave, kNave, kSpring, kRise, 2 * kHalfBay * i - kEnd);
  add_apse(plan);
  add_ends(plan);
  plan.distribute(request.triangles);
}

}  // namespace fasttree::scene
