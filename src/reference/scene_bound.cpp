// SPDX-License-Identifier: Apache-2.0
#include "reference/scene_bound.h"

#include <cmath>
#include <sstream>

namespace fasttree::reference {
namespace {

constexpr char kAxisName[3] = {'x', 'y', 'z'};

Status not_finite(std::uint32_t triangle, std::size_t corner, std::size_t axis, float value) {
  std::ostringstream message;
  message << "scene_bound: triangle " << triangle << ", corner " << corner << ", "
          << kAxisName[axis] << " is " << value
          << "; coordinates have to be finite. Remove or repair the triangle.";
  return {StatusCode::bad_input, message.str()};
}

Status extent_overflows(const Box3& bounds, std::size_t axis) {
  std::ostringstream message;
  message << "scene_bound: the scene reaches from " << bounds.lo[axis] << " to " << bounds.hi[axis]
          << " in " << kAxisName[axis]
          << ", an extent that a 32-bit float cannot hold. Scale the scene down.";
  return {StatusCode::bad_input, message.str()};
}

}  // namespace

Result<Box3> scene_bound(const MeshView& mesh) {
  if (mesh.triangle_count == 0) return Box3{{0, 0, 0}, {0, 0, 0}};
  Box3 bounds;
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const auto corners = mesh.triangle(t);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (std::size_t a = 0; a < 3; ++a) {
        if (!std::isfinite(corners[corner][a])) {
          return not_finite(t, corner, a, corners[corner][a]);
        }
      }
      bounds.include(corners[corner]);
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    bounds.lo[a] += 0.0f;  // minus zero becomes plus zero
    bounds.hi[a] += 0.0f;
    if (!std::isfinite(bounds.hi[a] - bounds.lo[a])) return extent_overflows(bounds, a);
  }
  return bounds;
}

}  // namespace fasttree::reference
