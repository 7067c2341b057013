// SPDX-License-Identifier: Apache-2.0
#include "live/frame_tracer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "live/ray_grid.h"
#include "render/colour.h"
#include "render/math.h"
#include "render/passes.h"
#include "render/surface.h"

namespace fasttree::live {
namespace {

using render::Double3;

constexpr std::size_t kShades = 1024;

/// Length 1, or zero. Scaled first: meshes may be tiny, and squares of tiny numbers are zero.
Vec3 unit(Vec3 a) {
  const float most = std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)});
  if (!(most > 0)) return {};
  a = a * (1 / most);
  return a * (1 / std::sqrt(dot(a, a)));
}

template <typename Body>
void for_each_tile(const TileOrder& order, const Body& body) {
  tbb::parallel_for(std::size_t{0}, order.tiles(), [&](std::size_t i) { body(i, order.tile(i)); });
}

}  // namespace

Vec3 place_light(const render::Camera& camera, const Tracer& tracer) {
  const render::CameraFrame frame(camera);
  const Double3 eye(camera.eye);
  const double distance = render::length(Double3(camera.target) - eye);
  const Double3 way = frame.up * (0.8 * distance) + frame.right * (0.45 * distance);
  const Hit blocked = tracer.closest(render::make_ray(eye, way));
  const double reach = blocked.hit() ? std::min(1.0, 0.9 * static_cast<double>(blocked.t)) : 1.0;
  return render::to_float(eye + way * reach);
}

FrameTracer::FrameTracer(std::uint32_t width, std::uint32_t height)
    : order_(width, height),
      rays_(order_.pixels()),
      hits_(order_.pixels()),
      surfaces_(order_.pixels()),
      tiles_(order_.tiles()),
      shadow_rays_(order_.pixels()),
      occluded_(order_.pixels()),
      shades_(kShades),
      background_(height) {
  const Double3 clay(0.80, 0.74, 0.66);
  for (std::size_t i = 0; i < kShades; ++i) {
    const double brightness = static_cast<double>(i) / (kShades - 1);
    shades_[i] = render::to_srgb(render::soft_shoulder(clay * (1.1 * brightness)));
  }
  const Double3 top = render::from_srgb(58, 66, 80), foot = render::from_srgb(150, 160, 172);
  for (std::uint32_t y = 0; y < height; ++y) {
    background_[y] = render::to_srgb(render::lerp(top, foot, (y + 0.5) / height));
  }
}

std::uint64_t FrameTracer::bytes(std::uint32_t width, std::uint32_t height) {
  const TileOrder order(width, height);
  return std::uint64_t{order.pixels()} * (2 * sizeof(Ray) + sizeof(Hit) + sizeof(Surface) + 1 + 3) +
         std::uint64_t{order.tiles()} * sizeof(TileCount);
}

TraceFigures FrameTracer::trace(const Tracer& tracer, const MeshView& mesh, const Shot& shot) {
  TraceFigures figures;
  shadows_ = shot.shadows;
  auto start = std::chrono::steady_clock::now();
  const RayGrid grid(shot.camera, order_.width(), order_.height());
  for_each_tile(order_, [&](std::size_t, const TileOrder::Tile& tile) {
    Ray* ray = &rays_[tile.first];
    for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (std::uint32_t x = tile.x0; x < tile.x1; ++x) *ray++ = grid.ray(x, y);
    }
  });
  tracer.closest(rays_, hits_, RayOrder::coherent);
  figures.primary_ms = render::milliseconds_since(start);
  figures.primary_rays = rays_.size();

  start = std::chrono::steady_clock::now();
  find_surfaces(mesh, shot);
  std::size_t shadow_rays = 0;
  for (TileCount& tile : tiles_) {
    tile.first_shadow = shadow_rays;
    shadow_rays += tile.shadow_rays;
    figures.hits += tile.hits;
  }
  if (shot.shadows) {
    for_each_tile(order_, [&](std::size_t i, const TileOrder::Tile& tile) {
      const Surface* surface = &surfaces_[tile.first];
      Ray* ray = shadow_rays_.data() + tiles_[i].first_shadow;
      for (Ray* const end = ray + tiles_[i].shadow_rays; ray != end; ++surface) {
        if (surface->lamp <= 0) continue;
        // From the light, so that a packet's rays share their origin.
        ray->origin = shot.light;
        ray->direction = surface->point - shot.light;
        ray->t_min = 0;
        ray->t_max = 0.9999f;
        ++ray;
      }
    });
    const std::span<std::uint8_t> flags(occluded_.data(), shadow_rays);
    tracer.occluded({shadow_rays_.data(), shadow_rays}, flags, RayOrder::coherent);
    figures.shadow_rays = shadow_rays;
  }
  figures.shadow_ms = render::milliseconds_since(start);
  if (shot.shadows) {
    figures.lit = static_cast<std::uint64_t>(
        std::count(occluded_.begin(), occluded_.begin() + static_cast<std::ptrdiff_t>(shadow_rays),
                   std::uint8_t{0}));
  }
  return figures;
}

void FrameTracer::find_surfaces(const MeshView& mesh, const Shot& shot) {
  for_each_tile(order_, [&](std::size_t i, const TileOrder::Tile& tile) {
    TileCount count;
    const std::size_t pixels = std::size_t{tile.x1 - tile.x0} * (tile.y1 - tile.y0);
    for (std::size_t p = tile.first; p < tile.first + pixels; ++p) {
      const Hit& hit = hits_[p];
      Surface& surface = surfaces_[p];
      surface.lamp = -1;
      if (!hit.hit()) continue;
      ++count.hits;
      const auto corners = mesh.triangle(hit.triangle);
      const Vec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0];
      Vec3 normal = unit(cross(unit(e1), unit(e2)));
      const Vec3 along = unit(rays_[p].direction);
      const float facing = dot(normal, along);
      if (facing > 0) normal = normal * -1.0f;
      const Vec3 point = corners[0] + e1 * hit.u + e2 * hit.v;
      const double size = render::max_component(Double3(e1)) + render::max_component(Double3(e2));
      surface.point =
          point + normal * static_cast<float>(render::ray_epsilon(Double3(point), size));
      surface.headlight = std::fabs(facing);
      surface.lamp = dot(normal, unit(shot.light - surface.point));
      if (surface.lamp > 0) ++count.shadow_rays;
    }
    tiles_[i] = count;
  });
}

void FrameTracer::shade(render::Image& image) const {
  image.width = order_.width();
  image.height = order_.height();
  image.rgb.resize(3 * order_.pixels());
  for_each_tile(order_, [&](std::size_t i, const TileOrder::Tile& tile) {
    std::size_t pixel = tile.first, shadow = tiles_[i].first_shadow;
    for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
      std::uint8_t* out = &image.rgb[3 * (std::size_t{y} * order_.width() + tile.x0)];
      for (std::uint32_t x = tile.x0; x < tile.x1; ++x, ++pixel, out += 3) {
        const auto* colour = &background_[y];
        if (hits_[pixel].hit()) {
          const Surface& surface = surfaces_[pixel];
          float brightness = 0.06f + 0.26f * surface.headlight;
          if (surface.lamp > 0) {
            const bool dark = shadows_ && occluded_[shadow] != 0;
            ++shadow;
            if (!dark) brightness += 0.68f * surface.lamp;
          }
          const float place = std::clamp(brightness, 0.0f, 1.0f) * (kShades - 1);
          colour = &shades_[static_cast<std::size_t>(place)];
        }
        std::copy(colour->begin(), colour->end(), out);
      }
    }
  });
}

}  // namespace fasttree::live
