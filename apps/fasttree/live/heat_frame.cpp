// SPDX-License-Identifier: Apache-2.0
#include "live/heat_frame.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>

#include "live/ray_grid.h"
#include "render/colour.h"
#include "render/legend.h"
#include "render/passes.h"

namespace fasttree::live {

double round_scale(double value) {
  if (!(value > 1)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (value <= factor * power) return factor * power;
  }
  return 10 * power;
}

HeatFrame::HeatFrame(std::uint32_t width, std::uint32_t height)
    : width_(width), height_(height), costs_(std::size_t{width} * height) {}

HeatFigures HeatFrame::draw(const Tracer& tracer, const render::Camera& camera,
                            render::Image& image) {
  HeatFigures figures;
  auto start = std::chrono::steady_clock::now();
  const RayGrid grid(camera, width_, height_);
  tbb::parallel_for(std::uint32_t{0}, height_, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < width_; ++x) {
      TraceCounters c;
      tracer.closest(grid.ray(x, y), c);
      costs_[std::size_t{y} * width_ + x] =
          static_cast<std::uint32_t>(c.inner_steps + c.leaf_visits + c.triangle_tests);
    }
  });
  figures.trace_ms = render::milliseconds_since(start);

  start = std::chrono::steady_clock::now();
  // A part of the pixels says as much of the scale's end as all of them.
  sample_.clear();
  for (std::size_t i = 0; i < costs_.size(); i += 13) sample_.push_back(costs_[i]);
  const auto end = sample_.begin() + static_cast<std::ptrdiff_t>((sample_.size() - 1) * 199 / 200);
  std::nth_element(sample_.begin(), end, sample_.end());
  figures.scale_max = round_scale(*end);
  figures.mean_cost =
      static_cast<double>(std::accumulate(costs_.begin(), costs_.end(), std::uint64_t{0})) /
      static_cast<double>(costs_.size());

  std::array<std::array<std::uint8_t, 3>, 256> colours;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    colours[i] = render::to_srgb(render::colour_scale(static_cast<double>(i) / 255));
  }
  image.width = width_;
  image.height = height_;
  image.rgb.resize(3 * costs_.size());
  const double scale = 255 / figures.scale_max;
  tbb::parallel_for(std::uint32_t{0}, height_, [&](std::uint32_t y) {
    for (std::size_t i = std::size_t{y} * width_; i < std::size_t{y + 1} * width_; ++i) {
      const auto& colour = colours[static_cast<std::size_t>(std::min(255.0, costs_[i] * scale))];
      std::copy(colour.begin(), colour.end(), &image.rgb[3 * i]);
    }
  });
  std::vector<render::LegendMark> marks;
  for (const double place : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    marks.push_back({place, render::short_number(place * figures.scale_max)});
  }
  render::draw_legend(
      image,
      "nodes visited + triangles tested a ray, mean " + render::short_number(figures.mean_cost),
      marks);
  figures.shade_ms = render::milliseconds_since(start);
  return figures;
}

}  // namespace fasttree::live
