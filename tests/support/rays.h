// SPDX-License-Identifier: Apache-2.0
// Rays that are hard for a kd-tree: in and along its planes, through edges, vertices and the
// corners of cells, and ordinary ones.
#pragma once

#include <cstdint>
#include <vector>

#include "fasttree/trace.h"
#include "fasttree/tree.h"
#include "tests/support/meshes.h"

namespace fasttree::test {

/// A mix of `count` rays of every kind over a mesh and the planes of its tree.
inline std::vector<Ray> hard_rays(const MeshView& mesh, const Tree& tree, std::size_t count,
                                  std::uint64_t seed) {
  std::vector<Ray> rays;
  if (mesh.triangle_count == 0) return rays;
  Random random(seed);
  const Box3 bounds = tree.info().bounds;
  const Vec3 extent = bounds.extent();

  // Coordinates where something happens: planes of the tree, else random ones.
  std::vector<float> planes[3];
  for (const Node& node : tree.nodes()) {
    if (!node.is_leaf()) planes[node.axis()].push_back(node.split());
  }
  const auto on_plane = [&](std::size_t a) {
    if (planes[a].empty()) return bounds.lo[a] + extent[a] * random.in(0, 1);
    return planes[a][random.below(static_cast<std::uint32_t>(planes[a].size()))];
  };
  const auto anywhere = [&](float margin) {
    Vec3 p;
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = bounds.lo[a] + extent[a] * random.in(-margin, 1 + margin);
    }
    return p;
  };
  const auto corner_of_cells = [&] { return Vec3{on_plane(0), on_plane(1), on_plane(2)}; };
  const auto triangle = [&] { return mesh.triangle(random.below(mesh.triangle_count)); };
  const auto on_edge = [&] {
    const auto t = triangle();
    const float s = random.in(0, 1);
    return t[0] * s + t[1] * (1 - s);
  };
  const auto on_triangle = [&] {
    const auto t = triangle();
    float u = random.in(0, 1), v = random.in(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    return t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
  };
  const auto towards = [&](Vec3 from, Vec3 to) { return Ray{from, 0, to - from}; };
  const auto axis_direction = [&] {
    Vec3 d;
    d[random.below(3)] = random.below(2) == 0 ? 1.0f : -1.0f;
    return d;
  };

  while (rays.size() < count) {
    Ray ray;
    switch (rays.size() % 14) {
      case 0:
        ray = towards(anywhere(1), anywhere(0));
        break;
      case 1:
        ray = towards(anywhere(0.2f), on_triangle());
        break;
      case 2:
        ray = towards(anywhere(1), triangle()[random.below(3)]);
        break;
      case 3:
        ray = towards(anywhere(1), on_edge());
        break;
      case 4:
        ray = towards(anywhere(0.5f), corner_of_cells());
        break;
      case 5:
        ray = towards(corner_of_cells(), corner_of_cells());
        break;
      case 6:
        ray = {corner_of_cells(), 0, axis_direction()};
        break;
      case 7:
        ray = {triangle()[random.below(3)], 0, axis_direction()};
        break;
      case 8: {  // in a plane, at any angle
        const std::size_t a = random.below(3);
        Vec3 from = anywhere(0.5f), to = anywhere(0);
        from[a] = to[a] = on_plane(a);
        ray = towards(from, to);
        break;
      }
      case 9: {  // nearly in a plane
        const std::size_t a = random.below(3);
        Vec3 from = anywhere(0.5f), to = anywhere(0);
        from[a] = on_plane(a);
        to[a] = from[a] + extent[a] * random.in(-1e-6f, 1e-6f);
        ray = towards(from, to);
        break;
      }
      case 10: {  // along an edge of a triangle: edge-on
        const auto t = triangle();
        ray = {t[0] - (t[1] - t[0]) * random.in(0, 2), 0, t[1] - t[0]};
        break;
      }
      case 11: {  // in the plane of a triangle
        const auto t = triangle();
        const Vec3 to = on_triangle();
        ray =
            towards(t[0] + (t[1] - t[0]) * random.in(-2, 2) + (t[2] - t[0]) * random.in(-2, 2), to);
        break;
      }
      case 12: {  // a segment, as shadow rays are
        const Vec3 from = on_triangle();
        ray = towards(from, anywhere(0.5f));
        ray.t_min = 1e-4f;
        ray.t_max = 1;
        break;
      }
      default: {  // direction of any length
        ray = towards(anywhere(1), on_triangle());
        const float length = random.below(2) == 0 ? 1e-6f : 1e6f;
        ray.direction = ray.direction * length;
        break;
      }
    }
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace fasttree::test
