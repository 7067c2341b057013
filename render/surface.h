// SPDX-License-Identifier: Apache-2.0
// What a hit looks like to the shader: where it is, which way it faces, how to leave it.
#pragma once

#include <vector>

#include "fasttree/mesh.h"
#include "fasttree/trace.h"
#include "render/math.h"

namespace fasttree::render {

/// Mean of the normals of the triangles around each vertex, weighted by their areas, length 1 or
/// zero. Linear in the mesh. Empty where the mesh has no indices: nothing is shared.
std::vector<Vec3> vertex_normals(const MeshView& mesh);

struct SurfacePoint {
  Double3 position;
  Double3 geometric;      ///< normal of the triangle, towards the viewer
  Double3 shading;        ///< interpolated normal, towards the viewer
  Double3 shadow_origin;  ///< lifted to where the smooth surface would be (Hanika 2021)
  double epsilon = 0;     ///< how far rays start above the surface
};

/// `normals` may be empty: flat. At a vertex whose mean normal is more than 50 degrees from the
/// triangle's own, the edge is meant to be sharp and the triangle's is taken.
SurfacePoint surface_point(const MeshView& mesh, const std::vector<Vec3>& normals, const Hit& hit,
                           Double3 viewed_along);

/// How far above a surface a ray has to start so as not to hit it: binary32's rounding of the
/// position and of what lies around it, not a share of the scene.
double ray_epsilon(Double3 position, double triangle_size);

}  // namespace fasttree::render
