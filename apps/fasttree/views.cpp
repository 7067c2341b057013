// SPDX-License-Identifier: Apache-2.0
#include "views.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "command.h"
#include "inputs.h"
#include "scene/procedural/procedural.h"

namespace fasttree::app {
namespace {

/// Rooms are looked at from inside. Only procedural scenes say what they are.
render::View view_for(const std::string& spec, render::View otherwise) {
  for (const scene::ProceduralInfo& info : scene::procedural_scenes()) {
    const std::string name = std::string("scene:") + info.name;
    if (info.interior && (spec == name || spec.starts_with(name + ":"))) {
      return render::View::inside;
    }
  }
  return otherwise;
}

}  // namespace

void CameraOptions::declare(Options& options) {
  using render::View;
  options.choice(view, "--view", "Where to look from",
                 Choices<std::optional<View>>{{"auto", std::nullopt},
                                              {"outside", View::outside},
                                              {"tight", View::tight},
                                              {"corner", View::corner},
                                              {"inside", View::inside}});
  options.point(eye, "--eye", "The camera's place");
  options.point(target, "--target", "What it looks at");
  options.point(up, "--up", "The direction that is up");
  options.number(fov_degrees, "--fov", "Angle of the picture's shorter side in degrees", 0.1, 179);
}

render::Camera CameraOptions::choose(const std::string& spec, const Box3& bounds,
                                     const Tracer& tracer, render::View otherwise) const {
  render::Camera camera =
      automatic_camera(bounds, view.value_or(view_for(spec, otherwise)), tracer);
  if (eye) camera.eye = *eye;
  if (target) {
    camera.target = *target;
  } else if (eye) {
    camera.target = bounds.lo * 0.5f + bounds.hi * 0.5f;
  }
  if (up) camera.up = *up;
  if (fov_degrees) camera.fov_degrees = static_cast<float>(*fov_degrees);
  if (camera.eye == camera.target) {
    throw Failure{kUsage, "--eye and --target are the same point; move one of them"};
  }
  return camera;
}

nlohmann::ordered_json json_of(const render::Camera& camera) {
  return {{"eye", json_of(camera.eye)},
          {"target", json_of(camera.target)},
          {"up", json_of(camera.up)},
          {"fov_degrees", camera.fov_degrees}};
}

std::string text_of(const render::Camera& camera) {
  return fmt::format("--eye {:.6g},{:.6g},{:.6g} --target {:.6g},{:.6g},{:.6g} --fov {:.6g}",
                     camera.eye.x, camera.eye.y, camera.eye.z, camera.target.x, camera.target.y,
                     camera.target.z, camera.fov_degrees);
}

}  // namespace fasttree::app
