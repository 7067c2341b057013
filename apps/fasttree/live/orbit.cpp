// SPDX-License-Identifier: Apache-2.0
#include "live/orbit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/camera_frame.h"

namespace fasttree::live {
namespace {

using render::Double3;

/// Short of the pole, where right and left would change places.
constexpr double kSteepest = 89.0 * std::numbers::pi / 180;
/// How near and far the wheel goes, as shares of the first distance.
constexpr double kNearest = 1e-3;
constexpr double kFarthest = 1e3;

Double3 up_of(const render::Camera& camera) {
  const Double3 up = render::normalized(Double3(camera.up));
  return render::length(up) > 0 ? up : Double3(0, 1, 0);
}

}  // namespace

OrbitCamera::OrbitCamera(const render::Camera& start) : start_(start), axes_(up_of(start)) {
  reset();
}

void OrbitCamera::reset() {
  target_ = Double3(start_.target);
  const Double3 arm = Double3(start_.eye) - target_;
  start_distance_ = distance_ = std::max(render::length(arm), 1e-30);
  const Double3 way = render::normalized(arm);
  azimuth_ = std::atan2(render::dot(way, axes_.bitangent), render::dot(way, axes_.tangent));
  elevation_ = std::clamp(std::asin(std::clamp(render::dot(way, axes_.normal), -1.0, 1.0)),
                          -kSteepest, kSteepest);
}

void OrbitCamera::turn(double right, double down) {
  azimuth_ = std::remainder(azimuth_ - right * std::numbers::pi, 2 * std::numbers::pi);
  elevation_ = std::clamp(elevation_ + down * std::numbers::pi, -kSteepest, kSteepest);
}

void OrbitCamera::zoom(double steps) {
  distance_ = std::clamp(distance_ * std::pow(0.9, steps), kNearest * start_distance_,
                         kFarthest * start_distance_);
}

void OrbitCamera::pan(double right, double up) {
  const render::CameraFrame frame(camera());
  const double seen = 2 * frame.half_side * distance_;
  target_ = target_ + frame.right * (right * seen) + frame.up * (up * seen);
}

render::Camera OrbitCamera::camera() const {
  render::Camera camera = start_;
  const double flat = std::cos(elevation_);
  const Double3 way =
      axes_(flat * std::cos(azimuth_), flat * std::sin(azimuth_), std::sin(elevation_));
  camera.target = render::to_float(target_);
  camera.eye = render::to_float(target_ + way * distance_);
  // Far from the origin a step of binary32 may be longer than the distance.
  if (camera.eye == camera.target) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double part = a == 0 ? way.x : a == 1 ? way.y : way.z;
      if (std::fabs(part) > 0.5) {
        camera.eye[a] = std::nextafter(camera.eye[a], part > 0 ? HUGE_VALF : -HUGE_VALF);
      }
    }
  }
  return camera;
}

}  // namespace fasttree::live
