// SPDX-License-Identifier: Apache-2.0
#include "render/render.h"

#include <array>
#include <chrono>
#include <cmath>
#include <new>

#include "render/math.h"
#include "render/modes.h"

namespace fasttree::render {

namespace {

constexpr std::array kModes{Mode::shaded, Mode::heat, Mode::leaves};
constexpr std::uint32_t kMaxSide = 32768;
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28;
constexpr std::uint32_t kMaxSamples = 4096;

Status invalid(const std::string& what) {
  return Status(StatusCode::invalid_argument, what);
}

Status check(const RenderSettings& s) {
  const std::uint64_t pixels = std::uint64_t{s.width} * s.height;
  if (s.width == 0 || s.height == 0 || s.width > kMaxSide || s.height > kMaxSide ||
      pixels > kMaxPixels) {
    return invalid("a picture of " + std::to_string(s.width) + " x " + std::to_string(s.height) +
                   " pixels; each side has to be 1 to 32768 and the whole at most 2^28 pixels");
  }
  const Camera& c = s.camera;
  if (!finite(c.eye) || !finite(c.target) || !finite(c.up) || c.eye == c.target) {
    return invalid("the camera's eye, target and up have to be finite and eye not the target");
  }
  if (!(c.fov_degrees > 0 && c.fov_degrees < 180))
    return invalid("the field of view has to be between 0 and 180 degrees");
  if (s.samples == 0 || s.samples > kMaxSamples)
    return invalid("antialiasing takes 1 to 4096 samples a pixel");
  if (s.ao_samples > kMaxSamples) return invalid("ambient occlusion takes 0 to 4096 samples");
  if (!(s.ao_radius >= 0) || !std::isfinite(s.ao_radius))
    return invalid("the radius of the ambient occlusion has to be 0 or more");
  if (s.light && !finite(*s.light)) return invalid("the light's position has to be finite");
  if (s.light_radius && !(*s.light_radius >= 0 && std::isfinite(*s.light_radius)))
    return invalid("the light's radius has to be 0 or more");
  if (!(s.heat_max >= 0) || !std::isfinite(s.heat_max))
    return invalid("the top of the cost scale has to be 0 (automatic) or more");
  if (s.slice_axis > 2) return invalid("the axis of the cutting plane has to be 0, 1 or 2");
  if (s.slice_position && !std::isfinite(*s.slice_position))
    return invalid("the position of the cutting plane has to be finite");
  return {};
}

std::uint64_t bytes_beside_image(const Scene& scene, const RenderSettings& settings) {
  switch (settings.mode) {
    case Mode::shaded:
      return shaded_bytes(scene, settings);
    case Mode::heat:
      return heat_bytes(settings);
    case Mode::leaves:
      return leaves_bytes(settings);
  }
  return 0;
}

std::uint64_t work_of(const RenderSettings& settings) {
  switch (settings.mode) {
    case Mode::shaded:
      return shaded_work(settings);
    case Mode::heat:
      return heat_work(settings);
    case Mode::leaves:
      return leaves_work(settings);
  }
  return 1;
}

bool draw(const Scene& scene, const RenderSettings& settings, Work& work, Image& image,
          RenderStats& stats) {
  switch (settings.mode) {
    case Mode::shaded:
      return draw_shaded(scene, settings, work, image, stats);
    case Mode::heat:
      return draw_heat(scene, settings, work, image, stats);
    case Mode::leaves:
      return draw_leaves(scene, settings, work, image, stats);
  }
  return true;
}

void add_up(RenderStats& stats) {
  double ms = 0;
  std::uint64_t rays = 0;
  for (const RayStats* r : {&stats.primary, &stats.shadow, &stats.ao}) {
    ms += r->ms;
    rays += r->rays;
    stats.counters.inner_steps += r->counters.inner_steps;
    stats.counters.leaf_visits += r->counters.leaf_visits;
    stats.counters.triangle_tests += r->counters.triangle_tests;
  }
  stats.mrays_per_s = ms > 0 ? static_cast<double>(rays) / (ms * 1e3) : 0;
}

}  // namespace

const char* to_string(Mode mode) {
  switch (mode) {
    case Mode::shaded:
      return "shaded";
    case Mode::heat:
      return "heat";
    case Mode::leaves:
      return "leaves";
  }
  return "unknown";
}

Result<Mode> parse_mode(const std::string& name) {
  for (const Mode mode : kModes)
    if (name == to_string(mode)) return mode;
  return invalid("no mode is called '" + name + "'; there are: shaded, heat, leaves");
}

Result<Image> render(const Tree& tree, const Tracer& tracer, const MeshView& mesh,
                     const RenderSettings& settings, RenderStats* stats) {
  const auto start = std::chrono::steady_clock::now();
  if (Status status = check(settings); !status.ok()) return status;

  const Scene scene{tree, tracer, mesh};
  const std::uint64_t image_bytes = 3 * std::uint64_t{settings.width} * settings.height;
  const std::uint64_t bytes = image_bytes + bytes_beside_image(scene, settings);
  if (settings.memory_limit_bytes != 0 && bytes > settings.memory_limit_bytes) {
    return Status(StatusCode::resource_limit,
                  "the picture takes " + std::to_string(bytes) + " bytes, the memory limit is " +
                      std::to_string(settings.memory_limit_bytes) +
                      "; ask for fewer pixels or flat shading, or raise the limit");
  }
  try {
    Image image;
    image.width = settings.width;
    image.height = settings.height;
    image.rgb.resize(image_bytes);
    RenderStats own;
    Work work(settings.progress, work_of(settings));
    if (!draw(scene, settings, work, image, own))
      return Status(StatusCode::cancelled, "cancelled while drawing the picture");
    own.total_ms = milliseconds_since(start);
    add_up(own);
    if (stats != nullptr) *stats = own;
    return image;
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::resource_limit, "out of memory for a picture of " +
                                                  std::to_string(bytes) +
                                                  " bytes; ask for fewer pixels or flat shading");
  }
}

}  // namespace fasttree::render
