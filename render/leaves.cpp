// SPDX-License-Identifier: Apache-2.0
// The tree's leaves where a plane cuts them, coloured by how many triangles they hold, and the mesh
// where the same plane cuts it.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "render/colour.h"
#include "render/legend.h"
#include "render/modes.h"

namespace fasttree::render {

namespace {

// The plane's own coordinates: `across` to the right, `upward` up.
struct Slice {
  std::size_t axis, across, upward;
  float position;
  double centre_a = 0, centre_u = 0;  ///< in the middle of the picture
  double pixel = 1;                   ///< size of a pixel in the scene
  double middle_x = 0, middle_y = 0;  ///< of the drawing, in pixels

  double a(double x) const { return centre_a + (x - middle_x) * pixel; }
  double u(double y) const { return centre_u - (y - middle_y) * pixel; }
  double x(double a_) const { return middle_x + (a_ - centre_a) / pixel; }
  double y(double u_) const { return middle_y - (u_ - centre_u) / pixel; }
};

Slice make_slice(const Scene& scene, const RenderSettings& settings) {
  const Box3& bounds = scene.tree.info().bounds;
  Slice s;
  s.axis = settings.slice_axis;
  // z is cut as seen from the front, y from above, x from the right.
  s.across = s.axis == 0 ? 2 : 0;
  s.upward = s.axis == 1 ? 2 : 1;
  const auto middle = [&](std::size_t axis) {
    return 0.5 * (static_cast<double>(bounds.lo[axis]) + bounds.hi[axis]);
  };
  s.position = settings.slice_position.value_or(static_cast<float>(middle(s.axis)));
  s.centre_a = middle(s.across);
  s.centre_u = middle(s.upward);
  const bool legend = settings.width >= kLegendMinSize && settings.height >= kLegendMinSize;
  const double height = settings.height * (legend ? 0.88 : 1.0);
  s.middle_x = 0.5 * settings.width;
  s.middle_y = 0.5 * height;
  const auto extent = [&](std::size_t axis) {
    return static_cast<double>(bounds.hi[axis]) - bounds.lo[axis];
  };
  s.pixel = std::max(extent(s.across) / settings.width, extent(s.upward) / height) / 0.94;
  if (!(s.pixel > 0)) s.pixel = 1;
  return s;
}

struct Cell {
  std::uint32_t triangles = 0;
  double lo_a, hi_a, lo_u, hi_u;
};

// The leaf a point of the plane lies in, and where the plane cuts its box.
std::optional<Cell> find_cell(const Tree& tree, const Slice& slice, double a, double u) {
  const Box3& bounds = tree.info().bounds;
  std::array<double, 3> point;
  point[slice.axis] = slice.position;
  point[slice.across] = a;
  point[slice.upward] = u;
  std::array<double, 3> lo, hi;
  for (std::size_t i = 0; i < 3; ++i) {
    lo[i] = bounds.lo[i];
    hi[i] = bounds.hi[i];
    if (!(lo[i] <= point[i] && point[i] <= hi[i])) return std::nullopt;
  }
  const auto nodes = tree.nodes();
  std::size_t i = 0;
  while (!nodes[i].is_leaf()) {
    const std::size_t axis = nodes[i].axis();
    const double split = nodes[i].split();
    if (point[axis] >= split) {
      lo[axis] = std::max(lo[axis], split);
      i = nodes[i].upper();
    } else {
      hi[axis] = std::min(hi[axis], split);
      ++i;
    }
  }
  return Cell{nodes[i].count(), lo[slice.across], hi[slice.across], lo[slice.upward],
              hi[slice.upward]};
}

std::uint32_t largest_leaf(const Tree& tree) {
  std::uint32_t largest = 0;
  for (const Node& node : tree.nodes())
    if (node.is_leaf()) largest = std::max(largest, node.count());
  return largest;
}

// Leaves by the logarithm of their size, so that one huge leaf does not darken all others. The
// darkest colours are left out: outlines have to show.
double scale_place(double triangles, double top) {
  return 0.12 + 0.88 * std::log1p(triangles) / std::log1p(top);
}

std::string shortest(float value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return std::string(text.data(), end);
}

Double3 cell_colour(const Cell& cell, double top) {
  static const Double3 kEmpty = from_srgb(228, 230, 233);
  if (cell.triangles == 0) return kEmpty;
  return colour_scale(scale_place(cell.triangles, top));
}

// Outlines one pixel wide, fainter where cells are so small that they would be all outline.
Double3 with_outline(Double3 colour, const Cell& cell, const Slice& slice, double a, double u) {
  const double edge =
      std::min({a - cell.lo_a, cell.hi_a - a, u - cell.lo_u, cell.hi_u - u}) / slice.pixel;
  if (edge >= 0.5) return colour;
  const double size = std::min(cell.hi_a - cell.lo_a, cell.hi_u - cell.lo_u) / slice.pixel;
  const double strength = 0.55 * std::clamp((size - 2) / 8, 0.0, 1.0);
  return lerp(colour, from_srgb(40, 44, 60), strength);
}

// A line one and a half pixels wide, blended by distance.
void draw_line(Image& image, double x0, double y0, double x1, double y1, Double3 ink) {
  constexpr double kHalf = 0.75;
  const double dx = x1 - x0, dy = y1 - y0, squared = dx * dx + dy * dy;
  const auto clip = [](double value, std::uint32_t size) {
    return static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const std::uint32_t left = clip(std::min(x0, x1) - 1, image.width);
  const std::uint32_t right = clip(std::max(x0, x1) + 2, image.width);
  const std::uint32_t top = clip(std::min(y0, y1) - 1, image.height);
  const std::uint32_t bottom = clip(std::max(y0, y1) + 2, image.height);
  for (std::uint32_t y = top; y < bottom; ++y) {
    for (std::uint32_t x = left; x < right; ++x) {
      const double px = x + 0.5 - x0, py = y + 0.5 - y0;
      const double along = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0;
      const double distance = std::hypot(px - along * dx, py - along * dy);
      const double cover = std::clamp(kHalf + 0.5 - distance, 0.0, 1.0);
      if (cover <= 0) continue;
      const std::uint8_t* old = &image.rgb[3 * (std::size_t{y} * image.width + x)];
      set_pixel(image, x, y, lerp(from_srgb(old[0], old[1], old[2]), ink, cover));
    }
  }
}

// Every triangle the plane goes through leaves a line.
void draw_cut(const MeshView& mesh, const Slice& slice, Image& image) {
  const Double3 ink = from_srgb(10, 60, 130);
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const auto p = mesh.triangle(t);
    std::array<std::array<double, 2>, 3> ends;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3 && count < 2; ++k) {
      const Vec3 &from = p[k], &to = p[(k + 1) % 3];
      const double d0 = static_cast<double>(from[slice.axis]) - slice.position;
      const double d1 = static_cast<double>(to[slice.axis]) - slice.position;
      if ((d0 >= 0) == (d1 >= 0)) continue;
      const double s = d0 / (d0 - d1);
      const auto at = [&](std::size_t axis) {
        return (1 - s) * static_cast<double>(from[axis]) + s * static_cast<double>(to[axis]);
      };
      ends[count++] = {slice.x(at(slice.across)), slice.y(at(slice.upward))};
    }
    if (count == 2) draw_line(image, ends[0][0], ends[0][1], ends[1][0], ends[1][1], ink);
  }
}

}  // namespace

std::uint64_t leaves_work(const RenderSettings& settings) {
  return tile_count(settings.width, settings.height);
}

std::uint64_t leaves_bytes(const RenderSettings&) {
  return 0;
}

bool draw_leaves(const Scene& scene, const RenderSettings& settings, Work& work, Image& image,
                 RenderStats& stats) {
  const Slice slice = make_slice(scene, settings);
  const double top = std::max<double>(largest_leaf(scene.tree), 1);
  const Double3 paper = from_srgb(250, 250, 250);
  const bool finished =
      for_tiles(settings.width, settings.height, work, "tree picture", [&](const Tile& tile) {
        // Four samples a pixel, so that small cells show as their mean.
        constexpr int kSide = 2;
        for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
          for (std::uint32_t x = tile.x0; x < tile.x1; ++x) {
            Double3 sum;
            for (int i = 0; i < kSide * kSide; ++i) {
              const double a = slice.a(x + (i % kSide + 0.5) / kSide);
              const double u = slice.u(y + (i / kSide + 0.5) / kSide);
              const std::optional<Cell> cell = find_cell(scene.tree, slice, a, u);
              sum += cell ? with_outline(cell_colour(*cell, top), *cell, slice, a, u) : paper;
            }
            set_pixel(image, x, y, sum * (1.0 / (kSide * kSide)));
          }
        }
      });
  if (!finished) return false;
  draw_cut(scene.mesh, slice, image);

  stats.scale_max = top;
  std::vector<LegendMark> marks;
  for (double n = 1; n < top; n *= 2) marks.push_back({scale_place(n, top), short_number(n)});
  marks.push_back({1.0, short_number(top)});
  draw_legend(image,
              std::string("triangles a leaf (grey: none), cut at ") + "xyz"[slice.axis] + " = " +
                  shortest(slice.position),
              marks);
  return true;
}

}  // namespace fasttree::render
