// SPDX-License-Identifier: Apache-2.0
// Meshes for the tests of the yardstick builders, and what any tree of theirs is held to.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "baseline/baseline.h"
#include "baseline/grow_tree.h"

namespace fasttree::baseline::testing {

/// Triangles without shared vertices.
struct Soup {
  std::vector<Vec3> positions;

  void add(Vec3 a, Vec3 b, Vec3 c) { positions.insert(positions.end(), {a, b, c}); }
  std::uint32_t size() const { return static_cast<std::uint32_t>(positions.size() / 3); }

  MeshView view() const {
    MeshView mesh;
    mesh.positions = positions.data();
    mesh.vertex_count = static_cast<std::uint32_t>(positions.size());
    mesh.triangle_count = size();
    return mesh;
  }

  Box3 bounds() const {
    Box3 box;
    for (const Vec3& p : positions) box.include(p);
    return positions.empty() ? Box3{{0, 0, 0}, {0, 0, 0}} : box;
  }
};

/// Triangles of about `size` scattered over the unit cube.
inline Soup random_soup(std::uint32_t count, float size, std::uint32_t seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> place(0.0f, 1.0f);
  std::uniform_real_distribution<float> offset(-size, size);
  Soup soup;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 centre{place(rng), place(rng), place(rng)};
    std::array<Vec3, 3> corners;
    for (Vec3& p : corners) p = centre + Vec3{offset(rng), offset(rng), offset(rng)};
    soup.add(corners[0], corners[1], corners[2]);
  }
  return soup;
}

/// Triangles with all corners on a coarse lattice: many planar and coinciding events.
inline Soup lattice_soup(std::uint32_t count, int steps, std::uint32_t seed) {
  std::mt19937 rng(seed);
  std::uniform_int_distribution<int> place(0, steps);
  Soup soup;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<Vec3, 3> corners;
    for (Vec3& p : corners) {
      for (std::size_t a = 0; a < 3; ++a) p[a] = static_cast<float>(place(rng));
    }
    soup.add(corners[0], corners[1], corners[2]);
  }
  return soup;
}

/// A closed surface of 2 * n * n triangles, a bumpy ball.
inline Soup bumpy_ball(int n) {
  const auto point = [n](int i, int j) {
    const double u = 2 * 3.14159265358979 * i / n;
    const double v = 3.14159265358979 * j / n;
    const double r = 1 + 0.2 * std::sin(5 * u) * std::sin(4 * v);
    return Vec3{static_cast<float>(r * std::cos(u) * std::sin(v)),
                static_cast<float>(r * std::sin(u) * std::sin(v)),
                static_cast<float>(r * std::cos(v))};
  };
  Soup soup;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      soup.add(point(i, j), point(i + 1, j), point(i + 1, j + 1));
      soup.add(point(i, j), point(i + 1, j + 1), point(i, j + 1));
    }
  }
  return soup;
}

enum class Which { exact, binned };

inline Result<Tree> build(const Soup& soup, Which which, const SahCosts& costs = {},
                          std::uint64_t memory_limit = 0, const ProgressCallback& progress = {}) {
  const MeshView mesh = soup.view();
  const BaselineInput input{mesh, soup.bounds(), costs, memory_limit, progress};
  return which == Which::exact ? build_sah_exact(input) : build_sah_binned(input);
}

/// A node with its cell, by index.
struct NodeCell {
  Box3 cell;
  std::uint32_t depth = 0;
};

/// Checks the form every tree of these builders has, and returns the cells of its nodes.
inline std::vector<NodeCell> check_structure(const Tree& tree, const Soup& soup, Which which) {
  const auto nodes = tree.nodes();
  const auto ids = tree.ids();
  const TreeInfo& info = tree.info();
  EXPECT_EQ(info.profile, which == Which::exact ? Profile::sah_exact : Profile::sah_binned);
  EXPECT_EQ(info.depth, 0);
  EXPECT_EQ(info.bits, (std::array<std::uint8_t, 3>{}));
  EXPECT_EQ(info.triangle_count, soup.size());
  EXPECT_EQ(info.bounds, soup.bounds());

  std::vector<NodeCell> cells(nodes.size());
  std::vector<std::uint32_t> appearances(soup.size(), 0);
  std::vector<std::pair<std::uint32_t, NodeCell>> open{{0, {soup.bounds(), 0}}};
  std::uint32_t next_node = 0;
  std::uint32_t next_id = 0;
  while (!open.empty()) {
    const auto [index, at] = open.back();
    open.pop_back();
    if (index != next_node || index >= nodes.size()) {
      ADD_FAILURE() << "node " << index << " found where pre-order has " << next_node;
      return cells;
    }
    ++next_node;
    cells[index] = at;
    const Node node = nodes[index];
    if (!node.is_leaf()) {
      const float split = node.split();
      EXPECT_LT(at.cell.lo[node.axis()], split) << "node " << index;
      EXPECT_GT(at.cell.hi[node.axis()], split) << "node " << index;
      NodeCell lower{at.cell, at.depth + 1};
      NodeCell upper{at.cell, at.depth + 1};
      lower.cell.hi[node.axis()] = split;
      upper.cell.lo[node.axis()] = split;
      open.push_back({node.upper(), upper});
      open.push_back({index + 1, lower});
      continue;
    }
    EXPECT_LE(at.depth, depth_bound(soup.size()));
    EXPECT_EQ(node.first(), next_id) << "leaf " << index;
    next_id += node.count();
    if (next_id > ids.size()) {
      ADD_FAILURE() << "leaf " << index << " ends after the ids";
      return cells;
    }
    for (std::uint32_t i = node.first(); i < next_id; ++i) {
      if (ids[i] >= soup.size()) {
        ADD_FAILURE() << "id " << ids[i] << " of " << soup.size();
        continue;
      }
      ++appearances[ids[i]];
      EXPECT_TRUE(i == node.first() || ids[i - 1] < ids[i]) << "leaf " << index;
    }
  }
  EXPECT_EQ(next_node, nodes.size());
  EXPECT_EQ(next_id, ids.size());
  EXPECT_LE(ids.size(), reference_bound(soup.size()));
  for (std::uint32_t t = 0; t < soup.size(); ++t) {
    if (appearances[t] == 0) ADD_FAILURE() << "triangle " << t << " is in no leaf";
  }
  return cells;
}

}  // namespace fasttree::baseline::testing
