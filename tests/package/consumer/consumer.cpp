// SPDX-License-Identifier: Apache-2.0
// Builds a tree over two triangles, traces one ray, prints what it hits.
#include <fasttree/fasttree.h>

#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
  // A square in the plane z = 2, as two triangles.
  const std::vector<fasttree::Vec3> positions{{0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}};
  const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};

  fasttree::MeshView mesh;
  mesh.positions = positions.data();
  mesh.vertex_count = 4;
  mesh.indices = indices.data();
  mesh.triangle_count = 2;

  const fasttree::Result<fasttree::Tree> tree = fasttree::Builder().build(mesh);
  if (!tree.ok()) {
    std::fprintf(stderr, "%s\n", tree.status().message().c_str());
    return 1;
  }
  const auto tracer = fasttree::Tracer::create(tree.value(), mesh);
  if (!tracer.ok()) {
    std::fprintf(stderr, "%s\n", tracer.status().message().c_str());
    return 1;
  }

  fasttree::Ray ray;
  ray.origin = {0.75f, 0.25f, 0};
  ray.direction = {0, 0, 1};
  const fasttree::Hit hit = tracer.value().closest(ray);
  if (!hit.hit()) return 1;
  std::printf("tree %s: triangle %u at t = %g\n",
              fasttree::hash_string(tree.value().hash()).c_str(), unsigned{hit.triangle},
              double{hit.t});
  return hit.triangle == 0 && hit.t == 2.0f ? 0 : 1;
}
