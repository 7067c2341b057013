// SPDX-License-Identifier: Apache-2.0
// Where the picture is taken from: by hand, or by itself from the scene's bounds.
#pragma once

#include <string>

#include "fasttree/status.h"
#include "fasttree/trace.h"
#include "fasttree/vec.h"

namespace fasttree::render {

/// A pinhole camera. y points up in all automatic views.
struct Camera {
  Vec3 eye{0, 0, 1};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 1, 0};           ///< need not be perpendicular; replaced where parallel to the view
  float fov_degrees = 60.0f;  ///< of the picture's shorter side, between 0 and 180

  friend bool operator==(const Camera&, const Camera&) = default;
};

/// Ways to choose a camera from a scene's bounds.
enum class View {
  outside,  ///< from +z, 1.5 of the bounds' diagonal from their centre, 60 degrees
  tight,    ///< from +z, 0.75 of the diagonal
  corner,   ///< from above, in front and to the right, so that the bounds fill the picture
  inside,   ///< from within, along the longest horizontal axis: for rooms and halls
};

/// "outside", "tight", "corner", "inside".
const char* to_string(View view);
/// invalid_argument lists the names.
Result<View> parse_view(const std::string& name);

/// The camera for a view of these bounds. Bounds that are empty or a single point give a camera
/// that looks at them from a distance of 1.
Camera automatic_camera(const Box3& bounds, View view = View::outside);

/// The same, but View::inside looks for a good place: of a grid of eyes within the bounds, one that
/// is enclosed by the scene, not close to anything, with a long free view. A fixed set of rays is
/// traced for it (some 100,000), so the same scene always gives the same camera.
Camera automatic_camera(const Box3& bounds, View view, const Tracer& tracer);

}  // namespace fasttree::render
