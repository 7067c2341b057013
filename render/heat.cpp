// SPDX-License-Identifier: Apache-2.0
// What each pixel's primary rays cost: inner nodes, leaves and triangle tests, as a colour.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "render/camera_frame.h"
#include "render/colour.h"
#include "render/legend.h"
#include "render/modes.h"
#include "render/sampling.h"

namespace fasttree::render {

namespace {

struct Cost {
  std::uint64_t sum = 0;  ///< over the pixel's samples
  bool touched = false;
};

// The value that one in two hundred pixels is above.
std::uint64_t percentile_995(const std::vector<Cost>& costs) {
  std::vector<std::uint64_t> sorted(costs.size());
  std::transform(costs.begin(), costs.end(), sorted.begin(), [](const Cost& c) { return c.sum; });
  const auto place = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) * 199 / 200);
  std::nth_element(sorted.begin(), place, sorted.end());
  return *place;
}

// Round numbers under the bar: steps of 1, 2 or 5 times a power of ten.
std::vector<LegendMark> marks_up_to(double top) {
  const double power = std::pow(10.0, std::floor(std::log10(top / 4)));
  const double factor = top / 4 / power;
  const double step = power * (factor < 1.5 ? 1 : factor < 3.5 ? 2 : factor < 7.5 ? 5 : 10);
  std::vector<LegendMark> marks;
  for (int i = 0; i * step <= top * (1 + 1e-9); ++i)
    marks.push_back({i * step / top, short_number(i * step)});
  return marks;
}

}  // namespace

std::uint64_t heat_work(const RenderSettings& settings) {
  return tile_count(settings.width, settings.height);
}

std::uint64_t heat_bytes(const RenderSettings& settings) {
  return std::uint64_t{settings.width} * settings.height * (sizeof(Cost) + sizeof(std::uint64_t));
}

bool draw_heat(const Scene& scene, const RenderSettings& settings, Work& work, Image& image,
               RenderStats& stats) {
  const CameraFrame camera(settings.camera);
  const std::uint32_t width = settings.width, height = settings.height;
  std::vector<Cost> costs(std::size_t{width} * height);
  PassCounters sums;
  const auto start = std::chrono::steady_clock::now();
  const bool finished = for_tiles(width, height, work, "primary rays", [&](const Tile& tile) {
    TraceCounters total;
    for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (std::uint32_t x = tile.x0; x < tile.x1; ++x) {
        TraceCounters c;
        Cost& cost = costs[std::size_t{y} * width + x];
        for (std::uint32_t i = 0; i < settings.samples; ++i) {
          const Sample2 s =
              settings.samples == 1 ? Sample2{0.5, 0.5} : sample(x, y, Purpose::pixel, i);
          const Double3 direction = camera.direction(x + s.u, y + s.v, width, height);
          cost.touched |= scene.tracer.closest(make_ray(camera.eye, direction), c).hit();
        }
        cost.sum = c.inner_steps + c.leaf_visits + c.triangle_tests;
        total.inner_steps += c.inner_steps;
        total.leaf_visits += c.leaf_visits;
        total.triangle_tests += c.triangle_tests;
      }
    }
    const std::uint64_t pixels = std::uint64_t{tile.x1 - tile.x0} * (tile.y1 - tile.y0);
    sums.add(pixels * settings.samples, total);
  });
  if (!finished) return false;
  stats.primary.ms = milliseconds_since(start);
  stats.primary.rays = sums.rays();
  stats.primary.counters = sums.counters();

  const double per_ray = 1.0 / settings.samples;
  double top = settings.heat_max;
  if (!(top > 0)) top = std::max(per_ray * static_cast<double>(percentile_995(costs)), 1.0);
  double total = 0;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const Cost& cost = costs[std::size_t{y} * width + x];
      const double mean = per_ray * static_cast<double>(cost.sum);
      total += mean;
      stats.hit_pixels += cost.touched ? 1 : 0;
      set_pixel(image, x, y, colour_scale(mean / top));
    }
  }
  stats.scale_max = top;
  stats.mean_cost = total / static_cast<double>(costs.size());
  draw_legend(image,
              "nodes visited + triangles tested a ray, mean " + short_number(stats.mean_cost),
              marks_up_to(top));
  return true;
}

}  // namespace fasttree::render
