// SPDX-License-Identifier: Apache-2.0
// Options for where a scene is looked at from.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "fasttree/trace.h"
#include "options.h"
#include "render/camera.h"

namespace fasttree::app {

struct CameraOptions {
  std::optional<render::View> view;  ///< none: chosen from the scene
  std::optional<Vec3> eye;
  std::optional<Vec3> target;
  std::optional<Vec3> up;
  std::optional<double> fov_degrees;

  void declare(Options& options);
  /// The view's camera, with what the options say of it by hand put in. `spec` is the scene's.
  /// Without --view, rooms are looked at from inside and all else as `otherwise` says.
  render::Camera choose(const std::string& spec, const Box3& bounds, const Tracer& tracer,
                        render::View otherwise = render::View::corner) const;
};

nlohmann::ordered_json json_of(const render::Camera& camera);
std::string text_of(const render::Camera& camera);

}  // namespace fasttree::app
