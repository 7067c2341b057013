// SPDX-License-Identifier: Apache-2.0
// A camera that a hand moves: around its target, nearer and farther, and sideways.
#pragma once

#include "render/camera.h"
#include "render/math.h"

namespace fasttree::live {

class OrbitCamera {
 public:
  explicit OrbitCamera(const render::Camera& start);

  /// Back to where it started.
  void reset();
  /// Around the target, by shares of the picture's shorter side: 1 is half a turn. Dragging to the
  /// right turns the scene to the right; dragging down shows more of it from above. Stops short of
  /// looking straight up or down.
  void turn(double right, double down);
  /// Nearer by a tenth for each step, farther for negative ones.
  void zoom(double steps);
  /// Moves camera and target sideways, by shares of what is seen at the target's distance.
  void pan(double right, double up);

  render::Camera camera() const;

 private:
  render::Camera start_;
  render::Basis axes_;  ///< its normal is up
  double start_distance_ = 1;
  render::Double3 target_;
  double distance_ = 1;
  double azimuth_ = 0;    ///< of the eye as seen from the target, radians from axes_.tangent
  double elevation_ = 0;  ///< above the horizontal plane
};

}  // namespace fasttree::live
