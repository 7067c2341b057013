// SPDX-License-Identifier: Apache-2.0
// Small meshes for tests: random ones, and the inputs that broke earlier kd-tree builders.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "fasttree/mesh.h"
#include "fasttree/vec.h"

namespace fasttree::test {

/// Triangles with three corners of their own, or indexed ones.
struct OwnedMesh {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> indices;

  MeshView view() const {
    MeshView mesh;
    mesh.positions = positions.data();
    mesh.vertex_count = static_cast<std::uint32_t>(positions.size());
    if (!indices.empty()) mesh.indices = indices.data();
    mesh.triangle_count =
        static_cast<std::uint32_t>((indices.empty() ? positions.size() : indices.size()) / 3);
    return mesh;
  }

  void add(Vec3 a, Vec3 b, Vec3 c) { positions.insert(positions.end(), {a, b, c}); }
};

/// Numbers that are the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  float in(float lo, float hi) {
    return lo + (hi - lo) * (static_cast<float>(engine_() >> 40) * 0x1p-24f);
  }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_() % n); }
  Vec3 point(float lo, float hi) {
    const float x = in(lo, hi), y = in(lo, hi), z = in(lo, hi);
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
};

/// Triangles of about `size`, uniformly in the unit cube.
inline OwnedMesh soup(std::uint32_t triangles, std::uint64_t seed, float size) {
  OwnedMesh mesh;
  Random random(seed);
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const Vec3 at = random.point(0, 1);
    const Vec3 b = at + random.point(-size, size);
    mesh.add(at, b, at + random.point(-size, size));
  }
  return mesh;
}

/// A bumpy closed-looking sheet with shared vertices: (n+1)^2 vertices, 2 n^2 triangles.
inline OwnedMesh sheet(std::uint32_t n, float bump) {
  OwnedMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const float x = static_cast<float>(i) / static_cast<float>(n);
      const float y = static_cast<float>(j) / static_cast<float>(n);
      mesh.positions.push_back({x, y, bump * std::sin(13 * x) * std::cos(11 * y)});
    }
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t v = j * (n + 1) + i;
      mesh.indices.insert(mesh.indices.end(), {v, v + 1, v + n + 1, v + 1, v + n + 2, v + n + 1});
    }
  }
  return mesh;
}

inline OwnedMesh moved(OwnedMesh mesh, Vec3 scale, Vec3 offset) {
  for (Vec3& p : mesh.positions) {
    p = {p.x * scale.x + offset.x, p.y * scale.y + offset.y, p.z * scale.z + offset.z};
  }
  return mesh;
}

/// A soup whose corners all lie on multiples of 1/cells: on the planes of the grid.
inline OwnedMesh snapped_soup(std::uint32_t triangles, std::uint64_t seed, std::uint32_t cells) {
  OwnedMesh mesh;
  Random random(seed);
  const auto snapped = [&] {
    const auto c = [&] {
      return static_cast<float>(random.below(cells + 1)) / static_cast<float>(cells);
    };
    const float x = c(), y = c(), z = c();
    return Vec3{x, y, z};
  };
  // The corners of the unit cube, so that planes lie on the multiples exactly.
  mesh.add({0, 0, 0}, {1, 1, 1}, {1, 0, 0});
  for (std::uint32_t t = 1; t < triangles; ++t) {
    const Vec3 a = snapped(), b = snapped();
    mesh.add(a, b, snapped());
  }
  return mesh;
}

struct NamedMesh {
  std::string name;
  OwnedMesh mesh;
};

/// Meshes that are valid and unusual.
inline std::vector<NamedMesh> degenerate_meshes() {
  std::vector<NamedMesh> list;
  const auto add = [&](const char* name, OwnedMesh mesh) {
    list.push_back({name, std::move(mesh)});
  };
  add("empty", {});
  add("one triangle", soup(1, 1, 0.5f));
  {
    OwnedMesh same;
    for (int i = 0; i < 300; ++i) same.add({0, 0, 0}, {1, 0, 0.5f}, {0, 1, 0.25f});
    add("all identical", same);
  }
  const OwnedMesh base = soup(400, 2, 0.1f);
  add("no extent in x", moved(base, {0, 1, 1}, {3, 0, 0}));
  add("no extent in y", moved(base, {1, 0, 1}, {0, 3, 0}));
  add("no extent in z", moved(base, {1, 1, 0}, {0, 0, 3}));
  add("only extent in x", moved(base, {1, 0, 0}, {0, 3, 3}));
  add("only extent in z", moved(base, {0, 0, 1}, {3, 3, 0}));
  add("one point", moved(base, {0, 0, 0}, {1, 2, 3}));
  add("slab of 1e-7", moved(base, {1, 1e-7f, 1}, {0, 0, 0}));
  add("slab of 2e-6", moved(base, {1, 1, 2e-6f}, {0, 0, 0}));
  add("offset 1e4", moved(base, {1, 1, 1}, {1e4f, -1e4f, 1e4f}));
  add("offset 1e5", moved(base, {1, 1, 1}, {1e5f, 1e5f, -1e5f}));
  add("offset 1e6", moved(base, {1, 1, 1}, {1e6f, 1e6f, 1e6f}));
  add("subnormal extent", moved(base, {1e-40f, 1e-40f, 1e-40f}, {0, 0, 0}));
  add("tiny extent", moved(base, {1e-33f, 1e-33f, 1e-33f}, {0, 0, 0}));
  add("huge extent", moved(base, {1e37f, 1e37f, 1e37f}, {-5e36f, 0, 0}));
  add("near the largest float", moved(base, {1e38f, 1e38f, 1e38f}, {1e38f, 1e38f, 1e38f}));
  add("on grid planes", snapped_soup(200, 3, 8));
  {
    OwnedMesh across = soup(500, 4, 0.01f);
    across.add({0, 0, 0}, {1, 1, 1}, {1, 0, 1});
    add("one triangle across the scene", across);
  }
  {
    OwnedMesh thin = soup(100, 5, 0.2f);
    for (int i = 0; i < 50; ++i) {
      const Vec3 p = thin.positions[static_cast<std::size_t>(3 * i)];
      thin.add(p, p, p);                           // a point
      thin.add(p, p + Vec3{0.3f, 0.2f, 0.1f}, p);  // a line
    }
    add("zero-area triangles", thin);
  }
  add("stretched", moved(base, {1000, 1, 0.001f}, {0, 0, 0}));
  add("negative zero", moved(base, {1, 1, -0.0f}, {-0.5f, -0.5f, -0.0f}));
  return list;
}

}  // namespace fasttree::test
