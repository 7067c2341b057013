// SPDX-License-Identifier: Apache-2.0
// The mesh, lit: a soft sky and ground, a point light with shadow, ambient occlusion.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/camera_frame.h"
#include "render/colour.h"
#include "render/modes.h"
#include "render/sampling.h"
#include "render/surface.h"

namespace fasttree::render {

namespace {

constexpr std::uint32_t kGround = kNoTriangle - 1;

// What one pixel keeps between the passes of a sample, and from sample to sample.
struct Pixel {
  Hit hit;
  float sum[3] = {0, 0, 0};
  bool lit = false;
  bool touched = false;  ///< some sample hit the mesh
};

class Picture {
 public:
  Picture(const Scene& scene, const RenderSettings& settings, Work& work, RenderStats& stats);
  bool draw(Image& image);

 private:
  bool trace_primary(std::uint32_t sample);
  bool trace_shadow(std::uint32_t sample);
  bool shade(std::uint32_t sample);

  // Runs body(x, y, pixel, counters), which returns the rays it traced, over all pixels.
  template <typename Body>
  bool pass(const char* stage, RayStats& stats, const Body& body);

  Double3 primary_direction(std::uint32_t x, std::uint32_t y, std::uint32_t sample) const;
  SurfacePoint surface(const Pixel& pixel, Double3 direction) const;
  Double3 light_point(std::uint32_t x, std::uint32_t y, std::uint32_t sample, Double3 from) const;
  Double3 background(std::uint32_t y) const;
  double open_sky(const SurfacePoint& s, std::uint32_t x, std::uint32_t y, std::uint32_t sample,
                  TraceCounters& counters, std::uint64_t& rays) const;
  double lit_share(Double3 lamp) const;
  void place_light();

  bool occluded(const Ray& ray, TraceCounters& counters) const {
    return count_ ? scene_.tracer.occluded(ray, counters) : scene_.tracer.occluded(ray);
  }

  const Scene& scene_;
  const RenderSettings& settings_;
  Work& work_;
  RenderStats& stats_;
  CameraFrame camera_;
  std::vector<Vec3> normals_;
  std::vector<Pixel> pixels_;
  bool count_ = false;
  bool ground_ = false;
  double ground_y_ = 0;
  double diagonal_ = 1;
  Double3 centre_;
  double occlusion_radius_ = 0;
  Double3 light_;
  double light_radius_ = 0;
  double light_reach_ = 1;  ///< distance at which the light has its nominal strength
};

Picture::Picture(const Scene& scene, const RenderSettings& settings, Work& work, RenderStats& stats)
    : scene_(scene),
      settings_(settings),
      work_(work),
      stats_(stats),
      camera_(settings.camera),
      count_(settings.count_cost) {
  const Box3& bounds = scene.tree.info().bounds;
  const bool any = scene.mesh.triangle_count > 0;
  if (any) {
    const Double3 extent = Double3(bounds.hi) - Double3(bounds.lo);
    centre_ = Double3(bounds.lo) + extent * 0.5;
    if (length(extent) > 0) diagonal_ = length(extent);
  }
  ground_ = settings.ground && any;
  ground_y_ = bounds.lo.y;
  const double view = length(Double3(settings.camera.target) - camera_.eye);
  occlusion_radius_ =
      settings.ao_radius > 0 ? settings.ao_radius : std::min(0.1 * diagonal_, 0.25 * view);
  if (settings.smooth && any) normals_ = vertex_normals(scene.mesh);
  pixels_.resize(std::size_t{settings.width} * settings.height);
  place_light();
}

// How much of what the camera sees is in the light of a lamp: a share of 64 places.
double Picture::lit_share(Double3 lamp) const {
  constexpr std::uint32_t kSide = 8;
  std::uint32_t seen = 0, lit = 0;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const Double3 direction = camera_.direction(settings_.width * (i % kSide + 0.5) / kSide,
                                                settings_.height * (i / kSide + 0.5) / kSide,
                                                settings_.width, settings_.height);
    const Hit hit = scene_.tracer.closest(make_ray(camera_.eye, direction));
    if (!hit.hit()) continue;
    ++seen;
    const SurfacePoint s = surface_point(scene_.mesh, {}, hit, direction);
    const Double3 way = lamp - s.position;
    if (dot(way, s.geometric) <= 0) continue;
    Ray ray = make_ray(s.position + s.geometric * s.epsilon, way);
    ray.t_max = 1 - 1e-4f;
    lit += scene_.tracer.occluded(ray) ? 0 : 1;
  }
  return seen > 0 ? static_cast<double>(lit) / seen : 1;
}

// Above the camera's right shoulder; in a room not behind its walls, and elsewhere where most of
// the picture would be in the dark.
void Picture::place_light() {
  const double distance = length(Double3(settings_.camera.target) - camera_.eye);
  if (settings_.light) {
    light_ = Double3(*settings_.light);
  } else {
    // Right, up and forward, in distances to the target.
    constexpr double kPlaces[][3] = {{0.5, 0.7, 0.2},    {-0.5, 0.7, 0.2}, {0.25, 0.45, 0.4},
                                     {-0.25, 0.45, 0.4}, {0.0, 0.6, 0.3},  {0.1, 0.25, 0.1}};
    double best = -1;
    for (const auto& place : kPlaces) {
      const Double3 offset =
          (camera_.right * place[0] + camera_.up * place[1] + camera_.forward * place[2]) *
          distance;
      const double reach = length(offset);
      const Hit wall = scene_.tracer.closest(make_ray(camera_.eye, normalized(offset)));
      const double shortened = wall.hit() && wall.t < 1.4 * reach ? 0.7 * wall.t / reach : 1;
      const Double3 lamp = camera_.eye + offset * shortened;
      const double share = lit_share(lamp);
      if (share > best) {
        best = share;
        light_ = lamp;
      }
      if (share > 0.5) break;
    }
  }
  light_reach_ = std::max(length(Double3(settings_.camera.target) - light_), 1e-30);
  light_radius_ = settings_.light_radius   ? static_cast<double>(*settings_.light_radius)
                  : settings_.samples >= 4 ? 0.06 * light_reach_
                                           : 0.0;
}

template <typename Body>
bool Picture::pass(const char* stage, RayStats& stats, const Body& body) {
  const auto start = std::chrono::steady_clock::now();
  PassCounters sums;
  const bool finished =
      for_tiles(settings_.width, settings_.height, work_, stage, [&](const Tile& tile) {
        TraceCounters counters;
        std::uint64_t rays = 0;
        for (std::uint32_t y = tile.y0; y < tile.y1; ++y)
          for (std::uint32_t x = tile.x0; x < tile.x1; ++x)
            rays += body(x, y, pixels_[std::size_t{y} * settings_.width + x], counters);
        sums.add(rays, counters);
      });
  stats.ms += milliseconds_since(start);
  stats.rays += sums.rays();
  const TraceCounters counters = sums.counters();
  stats.counters.inner_steps += counters.inner_steps;
  stats.counters.leaf_visits += counters.leaf_visits;
  stats.counters.triangle_tests += counters.triangle_tests;
  return finished;
}

Double3 Picture::primary_direction(std::uint32_t x, std::uint32_t y, std::uint32_t index) const {
  // One sample a pixel goes through its centre.
  const Sample2 s =
      settings_.samples == 1 ? Sample2{0.5, 0.5} : sample(x, y, Purpose::pixel, index);
  return camera_.direction(x + s.u, y + s.v, settings_.width, settings_.height);
}

bool Picture::trace_primary(std::uint32_t index) {
  return pass("primary rays", stats_.primary,
              [&](std::uint32_t x, std::uint32_t y, Pixel& pixel, TraceCounters& counters) {
                const Double3 direction = primary_direction(x, y, index);
                const Ray ray = make_ray(camera_.eye, direction);
                pixel.hit =
                    count_ ? scene_.tracer.closest(ray, counters) : scene_.tracer.closest(ray);
                pixel.touched |= pixel.hit.hit();
                if (ground_) {
                  const double t = (ground_y_ - camera_.eye.y) / direction.y;
                  if (t > 0 && t < pixel.hit.t) {
                    pixel.hit.t = static_cast<float>(t);
                    pixel.hit.triangle = kGround;
                  }
                }
                return std::uint64_t{1};
              });
}

SurfacePoint Picture::surface(const Pixel& pixel, Double3 direction) const {
  if (pixel.hit.triangle != kGround)
    return surface_point(scene_.mesh, normals_, pixel.hit, direction);
  SurfacePoint s;
  s.position = camera_.eye + direction * static_cast<double>(pixel.hit.t);
  s.position.y = ground_y_;
  s.geometric = s.shading = {0, direction.y > 0 ? -1.0 : 1.0, 0};
  s.shadow_origin = s.position;
  s.epsilon = ray_epsilon(s.position, 0);
  return s;
}

// A point of the light's disc, which faces the surface.
Double3 Picture::light_point(std::uint32_t x, std::uint32_t y, std::uint32_t index,
                             Double3 from) const {
  if (!(light_radius_ > 0)) return light_;
  const Sample2 s = disc(sample(x, y, Purpose::light, index));
  return light_ + Basis(normalized(light_ - from))(s.u, s.v, 0) * light_radius_;
}

bool Picture::trace_shadow(std::uint32_t index) {
  return pass("shadow rays", stats_.shadow,
              [&](std::uint32_t x, std::uint32_t y, Pixel& pixel, TraceCounters& counters) {
                pixel.lit = false;
                if (!pixel.hit.hit()) return std::uint64_t{0};
                const SurfacePoint s = surface(pixel, primary_direction(x, y, index));
                const Double3 to_light = light_point(x, y, index, s.position) - s.shadow_origin;
                if (dot(to_light, s.shading) <= 0) return std::uint64_t{0};
                if (!settings_.shadows) {
                  pixel.lit = true;
                  return std::uint64_t{0};
                }
                const double distance = length(to_light);
                Ray ray =
                    make_ray(s.shadow_origin + s.geometric * s.epsilon, to_light * (1 / distance));
                ray.t_max = static_cast<float>(distance * (1 - 1e-4));
                pixel.lit = !occluded(ray, counters);
                return std::uint64_t{1};
              });
}

// The share of the sky, weighted by the cosine, that nothing near hides.
double Picture::open_sky(const SurfacePoint& s, std::uint32_t x, std::uint32_t y,
                         std::uint32_t index, TraceCounters& counters, std::uint64_t& rays) const {
  if (settings_.ao_samples == 0) return 1;
  const Basis basis(s.shading);
  const Double3 origin = s.position + s.geometric * s.epsilon;
  std::uint32_t open = 0;
  for (std::uint32_t i = 0; i < settings_.ao_samples; ++i) {
    const Double3 local =
        cosine_hemisphere(sample(x, y, Purpose::occlusion, index * settings_.ao_samples + i));
    Double3 direction = basis(local.x, local.y, local.z);
    // Below the triangle's own plane there is nothing to see: mirror it.
    const double below = dot(direction, s.geometric);
    if (below < 0) direction = direction - s.geometric * (2 * below);
    Ray ray = make_ray(origin, direction);
    ray.t_max = static_cast<float>(occlusion_radius_);
    const bool floor = ground_ && direction.y < 0 && origin.y > ground_y_ &&
                       (origin.y - ground_y_) < -direction.y * occlusion_radius_;
    if (!occluded(ray, counters) && !floor) ++open;
  }
  rays += settings_.ao_samples;
  return static_cast<double>(open) / settings_.ao_samples;
}

Double3 Picture::background(std::uint32_t y) const {
  const double v = (y + 0.5) / settings_.height;
  return lerp(from_srgb(206, 213, 222), from_srgb(243, 243, 241), v * v * (3 - 2 * v));
}

bool Picture::shade(std::uint32_t index) {
  const Double3 clay = from_srgb(224, 214, 200);
  const Double3 sky{0.36, 0.40, 0.46}, earth{0.25, 0.22, 0.19};
  const Double3 sun{0.98, 0.91, 0.80};
  return pass(
      "shading", stats_.ao,
      [&](std::uint32_t x, std::uint32_t y, Pixel& pixel, TraceCounters& counters) {
        std::uint64_t rays = 0;
        Double3 colour = background(y);
        if (pixel.hit.hit()) {
          const Double3 direction = primary_direction(x, y, index);
          const SurfacePoint s = surface(pixel, direction);
          const double open = open_sky(s, x, y, index, counters, rays);
          const Double3 ambient = lerp(earth, sky, 0.5 + 0.5 * s.shading.y);
          const Double3 to_light = light_point(x, y, index, s.position) - s.shadow_origin;
          const double distance = length(to_light);
          const Double3 l = to_light * (1 / distance);
          const double ratio = distance / light_reach_;
          const double strength = 2 / (1.3 + 0.7 * ratio * ratio);
          const Double3 direct = sun * (strength * std::max(0.0, dot(s.shading, l)));
          // Light that was blocked comes from somewhere else, a little.
          const Double3 light = ambient * (0.1 + 0.9 * open) + (pixel.lit ? direct : Double3());
          if (pixel.hit.triangle == kGround) {
            // The floor is the background but for what the mesh takes of its light, and that fades
            // out.
            const Double3 all = ambient + direct;
            const Double3 left{light.x / all.x, light.y / all.y, light.z / all.z};
            const double away = length(s.position - Double3(centre_.x, ground_y_, centre_.z));
            const double fade = std::clamp((away / diagonal_ - 1.0) / 2.0, 0.0, 1.0);
            colour = colour * lerp(left, {1, 1, 1}, fade * fade * (3 - 2 * fade));
          } else {
            colour = clay * light;
            if (pixel.lit) {
              const double highlight = std::max(0.0, dot(s.shading, normalized(l - direction)));
              const double gloss = 0.05 * strength * std::pow(highlight, 40);
              colour += Double3(gloss, gloss, gloss);
            }
          }
        }
        pixel.sum[0] += static_cast<float>(colour.x);
        pixel.sum[1] += static_cast<float>(colour.y);
        pixel.sum[2] += static_cast<float>(colour.z);
        return rays;
      });
}

bool Picture::draw(Image& image) {
  for (std::uint32_t i = 0; i < settings_.samples; ++i)
    if (!trace_primary(i) || !trace_shadow(i) || !shade(i)) return false;
  const double scale = 1.0 / settings_.samples;
  for (std::uint32_t y = 0; y < settings_.height; ++y) {
    for (std::uint32_t x = 0; x < settings_.width; ++x) {
      const Pixel& pixel = pixels_[std::size_t{y} * settings_.width + x];
      stats_.hit_pixels += pixel.touched ? 1 : 0;
      const Double3 mean{pixel.sum[0] * scale, pixel.sum[1] * scale, pixel.sum[2] * scale};
      set_pixel(image, x, y, soft_shoulder(mean));
    }
  }
  return true;
}

}  // namespace

std::uint64_t shaded_work(const RenderSettings& settings) {
  return 3 * std::uint64_t{settings.samples} * tile_count(settings.width, settings.height);
}

std::uint64_t shaded_bytes(const Scene& scene, const RenderSettings& settings) {
  const bool smooth = settings.smooth && scene.mesh.indices != nullptr;
  return std::uint64_t{settings.width} * settings.height * sizeof(Pixel) +
         (smooth ? std::uint64_t{scene.mesh.vertex_count} * sizeof(Vec3) : 0);
}

bool draw_shaded(const Scene& scene, const RenderSettings& settings, Work& work, Image& image,
                 RenderStats& stats) {
  return Picture(scene, settings, work, stats).draw(image);
}

}  // namespace fasttree::render
