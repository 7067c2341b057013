// SPDX-License-Identifier: Apache-2.0
// A camera made ready for shooting rays.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "fasttree/trace.h"
#include "render/camera.h"
#include "render/math.h"

namespace fasttree::render {

struct CameraFrame {
  Double3 eye, right, up, forward;
  double half_side = 0;  ///< of the picture's shorter side at distance 1

  explicit CameraFrame(const Camera& camera)
      : eye(camera.eye), half_side(std::tan(0.5 * camera.fov_degrees * std::numbers::pi / 180)) {
    forward = normalized(Double3(camera.target) - eye);
    right = cross(forward, normalized(Double3(camera.up)));
    if (length(right) < 1e-6) right = Basis(forward).tangent;
    right = normalized(right);
    up = cross(right, forward);
  }

  /// The direction, of length 1, through the point (x, y) of a picture, in pixels from its top
  /// left.
  Double3 direction(double x, double y, std::uint32_t width, std::uint32_t height) const {
    const double scale = 2 * half_side / std::min(width, height);
    return normalized(forward + right * ((x - 0.5 * width) * scale) +
                      up * ((0.5 * height - y) * scale));
  }
};

inline Ray make_ray(Double3 origin, Double3 direction) {
  Ray ray;
  ray.origin = to_float(origin);
  ray.direction = to_float(direction);
  return ray;
}

}  // namespace fasttree::render
