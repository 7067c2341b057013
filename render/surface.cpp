// SPDX-License-Identifier: Apache-2.0
#include "render/surface.h"

#include <array>

namespace fasttree::render {

std::vector<Vec3> vertex_normals(const MeshView& mesh) {
  std::vector<Vec3> normals;
  if (mesh.indices == nullptr) return normals;

  // Areas are relative to the mesh's size, so that neither tiny nor huge meshes leave binary32.
  Box3 bounds;
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) bounds.include(mesh.position(v));
  const double size = max_component(Double3(bounds.hi) - Double3(bounds.lo));
  if (!(size > 0)) return normals;
  const double scale = 1 / size;

  normals.resize(mesh.vertex_count);
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const auto [a, b, c] = mesh.triangle(t);
    const Double3 twice_area =
        cross((Double3(b) - Double3(a)) * scale, (Double3(c) - Double3(a)) * scale);
    for (std::uint32_t k = 0; k < 3; ++k) {
      Vec3& n = normals[mesh.vertex_index(t, k)];
      n = n + to_float(twice_area);
    }
  }
  for (Vec3& n : normals) n = to_float(normalized(Double3(n)));
  return normals;
}

double ray_epsilon(Double3 position, double triangle_size) {
  constexpr double kSteps = 64 * 0x1p-24;
  return kSteps * (max_component(position) + triangle_size);
}

SurfacePoint surface_point(const MeshView& mesh, const std::vector<Vec3>& normals, const Hit& hit,
                           Double3 viewed_along) {
  const auto corners = mesh.triangle(hit.triangle);
  const std::array<Double3, 3> p{Double3(corners[0]), Double3(corners[1]), Double3(corners[2])};
  const std::array<double, 3> weight{1.0 - hit.u - hit.v, hit.u, hit.v};

  SurfacePoint s;
  s.position = p[0] * weight[0] + p[1] * weight[1] + p[2] * weight[2];
  const Double3 e1 = p[1] - p[0], e2 = p[2] - p[0];
  const Double3 front = normalized(cross(normalized(e1), normalized(e2)));
  const double side = dot(front, viewed_along) > 0 ? -1.0 : 1.0;
  s.geometric = front * side;
  s.epsilon = ray_epsilon(s.position, max_component(e1) + max_component(e2));
  s.shading = s.geometric;
  s.shadow_origin = s.position;
  if (normals.empty()) return s;

  constexpr double kSharp = 0.643;  // cosine of 50 degrees
  Double3 smooth, lift;
  for (std::uint32_t k = 0; k < 3; ++k) {
    // Scanned meshes have a fold here and there whose triangles wind the other way.
    Double3 n(normals[mesh.vertex_index(hit.triangle, k)]);
    const double cosine = dot(n, front);
    n = std::fabs(cosine) < kSharp ? s.geometric : n * (cosine < 0 ? -side : side);
    smooth += n * weight[k];
    lift += n * (weight[k] * -std::fmin(0.0, dot(s.position - p[k], n)));
  }
  smooth = normalized(smooth);
  // A normal that faces away from the viewer would show the surface from behind.
  const double away = dot(smooth, viewed_along);
  if (away > 0) smooth = normalized(smooth - viewed_along * (1.001 * away));
  s.shading = smooth;
  s.shadow_origin = s.position + lift;
  return s;
}

}  // namespace fasttree::render
