// SPDX-License-Identifier: Apache-2.0
// For tests: meshes and trees made in the plainest way there is, so that they can judge the rest.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "fasttree/device_image.h"
#include "fasttree/mesh.h"
#include "fasttree/tree.h"
#include "grid/grid.h"

namespace fasttree::test {

using Rng = std::mt19937_64;

inline std::uint32_t below(Rng& rng, std::uint32_t end) {
  return std::uniform_int_distribution<std::uint32_t>(0, end - 1)(rng);
}

inline float between(Rng& rng, float lo, float hi) {
  return std::uniform_real_distribution<float>(lo, hi)(rng);
}

/// Triangles without indices.
struct Mesh {
  std::vector<Vec3> corners;

  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(corners.size() / 3); }

  MeshView view() const {
    MeshView v;
    v.positions = corners.data();
    v.vertex_count = static_cast<std::uint32_t>(corners.size());
    v.triangle_count = triangle_count();
    return v;
  }

  Box3 bounds() const {
    if (corners.empty()) return {{0, 0, 0}, {0, 0, 0}};
    Box3 b;
    for (const Vec3& p : corners) b.include(p);
    return b;
  }
};

/// Small triangles in a box of 4 x 2 x 1; a few reach across it, lie in planes or have no area.
inline Mesh random_mesh(Rng& rng, std::uint32_t triangles) {
  const Vec3 size{4, 2, 1};
  Mesh mesh;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const float reach = below(rng, 8) == 0 ? 1.0f : 0.1f;
    const std::uint32_t flat = below(rng, 12);  // 0 to 2: flat on that axis; 3: a point
    Vec3 base;
    for (std::size_t a = 0; a < 3; ++a) base[a] = size[a] * between(rng, 0, 1);
    if (flat < 3) base[flat] = size[flat] * 0.25f * static_cast<float>(below(rng, 5));
    for (int corner = 0; corner < 3; ++corner) {
      Vec3 p = base;
      for (std::size_t a = 0; a < 3; ++a) {
        if (a == flat || flat == 3) continue;
        p[a] = std::clamp(p[a] + size[a] * reach * between(rng, -1, 1), 0.0f, size[a]);
      }
      mesh.corners.push_back(p);
    }
  }
  return mesh;
}

/// The tree of profile paper, by recursion over sorted references.
class PlainPaperBuilder {
 public:
  PlainPaperBuilder(const Mesh& mesh, AxisSchedule axes, int depth)
      : grid_(mesh.bounds(), axes, depth), triangle_count_(mesh.triangle_count()) {
    for (std::uint32_t t = 0; t < triangle_count_; ++t) {
      const auto [lo, hi] = grid_.cells_of(mesh.view().triangle(t));
      for (std::uint32_t z = lo[2]; z <= hi[2]; ++z) {
        for (std::uint32_t y = lo[1]; y <= hi[1]; ++y) {
          for (std::uint32_t x = lo[0]; x <= hi[0]; ++x) {
            references_.emplace_back(grid_.morton_code({x, y, z}), t);
          }
        }
      }
    }
    std::sort(references_.begin(), references_.end());
  }

  Tree build() {
    subtree(0, references_.size(), 0);
    std::vector<std::uint32_t> ids;
    for (const auto& [code, triangle] : references_) ids.push_back(triangle);
    return Tree(grid_.tree_info(triangle_count_), nodes_, ids);
  }

 private:
  // The references [begin, end) agree in the codes' first `level` bits.
  void subtree(std::size_t begin, std::size_t end, int level) {
    for (; level < grid_.depth(); ++level) {
      const std::uint32_t bit = 1u << (grid_.depth() - 1 - level);
      std::size_t middle = begin;
      while (middle < end && !(references_[middle].first & bit)) ++middle;
      if (middle == begin || middle == end) continue;  // an empty side: no node
      const std::uint32_t prefix = references_[middle].first & ~(bit - 1);
      const auto axis = static_cast<std::uint32_t>(grid_.axis_of_level(level));
      const float split = grid_.plane(axis, grid_.cell_of(prefix)[axis]);
      const std::size_t at = nodes_.size();
      nodes_.push_back({});
      subtree(begin, middle, level + 1);
      nodes_[at] = Node::inner(axis, split, static_cast<std::uint32_t>(nodes_.size()));
      subtree(middle, end, level + 1);
      return;
    }
    nodes_.push_back(
        Node::leaf(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin)));
  }

  Grid grid_;
  std::uint32_t triangle_count_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> references_;
  std::vector<Node> nodes_;
};

inline Tree plain_paper_tree(const Mesh& mesh, AxisSchedule axes, int depth) {
  return PlainPaperBuilder(mesh, axes, depth).build();
}

/// A tree without grid: random planes, triangles sorted by their boxes.
class PlainBoxBuilder {
 public:
  PlainBoxBuilder(const Mesh& mesh, Rng& rng, int depth) : rng_(rng) {
    info_.profile = Profile::sah_binned;
    info_.triangle_count = mesh.triangle_count();
    info_.bounds = mesh.bounds();
    std::vector<std::uint32_t> all;
    for (std::uint32_t t = 0; t < info_.triangle_count; ++t) {
      all.push_back(t);
      Box3 box;
      for (const Vec3& p : mesh.view().triangle(t)) box.include(p);
      boxes_.push_back(box);
    }
    subtree(all, info_.bounds, depth);
  }

  Tree build() { return Tree(info_, nodes_, ids_); }

 private:
  void subtree(const std::vector<std::uint32_t>& triangles, Box3 cell, int depth) {
    const std::uint32_t axis = below(rng_, 3);
    if (depth == 0 || triangles.size() < 2) {
      nodes_.push_back(Node::leaf(static_cast<std::uint32_t>(ids_.size()),
                                  static_cast<std::uint32_t>(triangles.size())));
      ids_.insert(ids_.end(), triangles.begin(), triangles.end());
      return;
    }
    const float split =
        std::clamp(between(rng_, cell.lo[axis], cell.hi[axis]), cell.lo[axis], cell.hi[axis]);
    std::vector<std::uint32_t> lower;
    std::vector<std::uint32_t> upper;
    for (const std::uint32_t t : triangles) {
      if (boxes_[t].lo[axis] < split) lower.push_back(t);
      if (boxes_[t].hi[axis] >= split) upper.push_back(t);
    }
    Box3 lower_cell = cell;
    Box3 upper_cell = cell;
    lower_cell.hi[axis] = upper_cell.lo[axis] = split;
    const std::size_t at = nodes_.size();
    nodes_.push_back({});
    subtree(lower, lower_cell, depth - 1);
    nodes_[at] = Node::inner(axis, split, static_cast<std::uint32_t>(nodes_.size()));
    subtree(upper, upper_cell, depth - 1);
  }

  Rng& rng_;
  TreeInfo info_;
  std::vector<Box3> boxes_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> ids_;
};

inline Tree plain_box_tree(const Mesh& mesh, Rng& rng, int depth) {
  return PlainBoxBuilder(mesh, rng, depth).build();
}

/// Links and runs of any shape, with nothing geometric about them: for what only moves bytes.
inline Tree random_shape(Rng& rng, std::uint32_t leaves) {
  std::vector<Node> nodes;
  std::vector<std::uint32_t> ids;
  // Each entry is a subtree that still has to be written: how many leaves, and whose upper child.
  constexpr std::size_t kNoParent = ~std::size_t{0};
  std::vector<std::pair<std::uint32_t, std::size_t>> waiting{{leaves, kNoParent}};
  while (!waiting.empty()) {
    const auto [count, parent] = waiting.back();
    waiting.pop_back();
    const std::size_t at = nodes.size();
    if (parent != kNoParent) {
      nodes[parent] =
          Node::inner(nodes[parent].axis(), nodes[parent].split(), static_cast<std::uint32_t>(at));
    }
    if (count == 1) {
      const std::uint32_t size = below(rng, 4);
      nodes.push_back(Node::leaf(static_cast<std::uint32_t>(ids.size()), size));
      for (std::uint32_t k = 0; k < size; ++k) ids.push_back(static_cast<std::uint32_t>(rng()));
      continue;
    }
    const std::uint32_t lower = 1 + below(rng, count - 1);
    nodes.push_back(Node::inner(below(rng, 3), between(rng, -1, 1), 0));
    waiting.emplace_back(count - lower, at);
    waiting.emplace_back(lower, kNoParent);
  }
  TreeInfo info;
  info.profile = static_cast<Profile>(below(rng, 3));
  info.axes = static_cast<AxisSchedule>(below(rng, 2));
  info.depth = static_cast<std::uint8_t>(below(rng, 31));
  info.bits = {static_cast<std::uint8_t>(below(rng, 16)), 1, 2};
  info.triangle_count = static_cast<std::uint32_t>(rng());
  info.bounds = {{between(rng, -2, -1), -3, 0}, {between(rng, 1, 2), 3, 0}};
  return Tree(info, std::move(nodes), std::move(ids));
}

inline bool same(const Tree& a, const Tree& b) {
  return a.info() == b.info() && std::ranges::equal(a.nodes(), b.nodes()) &&
         std::ranges::equal(a.ids(), b.ids());
}

inline std::vector<Node> nodes_of(const Tree& tree) {
  return {tree.nodes().begin(), tree.nodes().end()};
}

inline std::vector<std::uint32_t> ids_of(const Tree& tree) {
  return {tree.ids().begin(), tree.ids().end()};
}

}  // namespace fasttree::test
