// SPDX-License-Identifier: Apache-2.0
#include "measure.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fasttree::app {
namespace {

constexpr float kPi = 3.14159265358979f;

Vec3 normalised(Vec3 v) {
  const float length = std::sqrt(dot(v, v));
  return length > 0 ? v * (1.0f / length) : Vec3{0, 0, 1};
}

/// Two numbers in [0, 1) from a ray's number: Martin Roberts' R2 sequence, which needs no state.
std::array<float, 2> r2(std::uint64_t i) {
  const auto fraction = [&](double alpha) {
    const double x = 0.5 + alpha * static_cast<double>(i);
    return static_cast<float>(x - std::floor(x));
  };
  return {fraction(0.7548776662466927), fraction(0.5698402909980532)};
}

/// Cosine-distributed round the normal.
Vec3 diffuse_direction(Vec3 normal, std::uint64_t i) {
  const auto [a, b] = r2(i);
  const Vec3 side =
      normalised(cross(std::fabs(normal.x) > 0.5f ? Vec3{0, 1, 0} : Vec3{1, 0, 0}, normal));
  const Vec3 other = cross(normal, side);
  const float r = std::sqrt(a);
  const float angle = 2.0f * kPi * b;
  return side * (r * std::cos(angle)) + other * (r * std::sin(angle)) +
         normal * std::sqrt(std::max(0.0f, 1.0f - a));
}

}  // namespace

const char* to_string(RayKind kind) {
  switch (kind) {
    case RayKind::primary:
      return "primary";
    case RayKind::shadow:
      return "shadow";
    case RayKind::diffuse:
      return "diffuse";
  }
  return "unknown";
}

MeasuredRays make_measured_rays(const render::Camera& camera, const RaySettings& settings,
                                const MeshView& mesh, const Box3& bounds, const Tracer& tracer) {
  constexpr std::uint32_t kTile = 8;
  MeasuredRays result;
  const std::uint32_t width = settings.width, height = settings.height;
  const Vec3 forward = normalised(camera.target - camera.eye);
  Vec3 right = cross(forward, camera.up);
  if (dot(right, right) < 1e-12f) right = cross(forward, {1, 0, 0});
  if (dot(right, right) < 1e-12f) right = cross(forward, {0, 0, 1});
  right = normalised(right);
  const Vec3 up = cross(right, forward);
  const float half_side = std::tan(camera.fov_degrees * kPi / 360.0f);
  const float pixel = 2.0f * half_side / static_cast<float>(std::min(width, height));

  auto& primary = result.rays[0];
  primary.reserve(std::size_t{width} * height);
  const auto add = [&](std::uint32_t x, std::uint32_t y) {
    const float u = (static_cast<float>(x) + 0.5f - 0.5f * static_cast<float>(width)) * pixel;
    const float v = (0.5f * static_cast<float>(height) - static_cast<float>(y) - 0.5f) * pixel;
    Ray ray;
    ray.origin = camera.eye;
    ray.direction = forward + right * u + up * v;
    primary.push_back(ray);
  };
  for (std::uint32_t top = 0; top < height; top += kTile) {
    for (std::uint32_t left = 0; left < width; left += kTile) {
      for (std::uint32_t y = top; y < std::min(top + kTile, height); ++y) {
        for (std::uint32_t x = left; x < std::min(left + kTile, width); ++x) add(x, y);
      }
    }
  }
  std::vector<Hit> hits(primary.size());
  tracer.closest(primary, hits);

  const Vec3 extent = bounds.extent();
  const float diagonal = std::sqrt(dot(extent, extent));
  const Vec3 light = settings.light.value_or(camera.eye + (right + up) * (0.25f * diagonal));
  result.light = light;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].hit()) continue;
    const auto [a, b, c] = mesh.triangle(hits[i].triangle);
    Vec3 normal = normalised(cross(b - a, c - a));
    if (dot(normal, primary[i].direction) > 0) normal = normal * -1.0f;
    // Off the surface, so that the triangle does not hide itself.
    const Vec3 point =
        primary[i].origin + primary[i].direction * hits[i].t + normal * (1e-4f * diagonal);
    Ray shadow;
    shadow.origin = point;
    shadow.direction = light - point;
    shadow.t_max = 1.0f;
    result.rays[1].push_back(shadow);
    Ray diffuse;
    diffuse.origin = point;
    diffuse.direction = diffuse_direction(normal, i);
    result.rays[2].push_back(diffuse);
  }
  return result;
}

TraceCounters count_rays(const Tracer& tracer, RayKind kind, std::span<const Ray> rays) {
  const auto add = [](TraceCounters a, const TraceCounters& b) {
    a.inner_steps += b.inner_steps;
    a.leaf_visits += b.leaf_visits;
    a.triangle_tests += b.triangle_tests;
    return a;
  };
  return oneapi::tbb::parallel_reduce(
      oneapi::tbb::blocked_range<std::size_t>(0, rays.size(), 256), TraceCounters{},
      [&](const auto& range, TraceCounters sum) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          if (kind == RayKind::shadow) {
            tracer.occluded(rays[i], sum);
          } else {
            tracer.closest(rays[i], sum);
          }
        }
        return sum;
      },
      add);
}

}  // namespace fasttree::app
