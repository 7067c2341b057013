// SPDX-License-Identifier: Apache-2.0
// A camera's rays through the middles of pixels, cheap to make: no root, no division.
#pragma once

#include <cstdint>

#include "fasttree/trace.h"
#include "render/camera_frame.h"

namespace fasttree::live {

class RayGrid {
 public:
  RayGrid(const render::Camera& camera, std::uint32_t width, std::uint32_t height) {
    const render::CameraFrame frame(camera);
    const double scale = 2 * frame.half_side / std::min(width, height);
    eye_ = camera.eye;
    right_ = render::to_float(frame.right * scale);
    down_ = render::to_float(frame.up * -scale);
    corner_ = render::to_float(frame.forward + frame.right * (scale * (0.5 - 0.5 * width)) +
                               frame.up * (scale * (0.5 * height - 0.5)));
  }

  /// The directions' length is not 1.
  Ray ray(std::uint32_t x, std::uint32_t y) const {
    Ray ray;
    ray.origin = eye_;
    ray.direction = corner_ + right_ * static_cast<float>(x) + down_ * static_cast<float>(y);
    return ray;
  }

 private:
  Vec3 eye_;
  Vec3 right_, down_;  ///< one pixel
  Vec3 corner_;        ///< direction of the top left pixel
};

}  // namespace fasttree::live
