// SPDX-License-Identifier: Apache-2.0
#include "trace/wide_layout.h"

#include <tbb/task_group.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "trace/leaf_triangles.h"

namespace fasttree {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kNotWide = 0xffffffffu;

// Subtrees with fewer kd nodes are not worth a task of their own.
constexpr std::size_t kNodesPerTask = 512;

// Triangles a child has where a large leaf is cut into at most 16 parts.
std::uint32_t part_size(std::uint32_t count) {
  std::uint64_t size = kMostInLeaf;
  while (size * kWide < count) size *= kWide;
  return static_cast<std::uint32_t>(size);
}

// Wide nodes over the parts of a leaf.
std::uint32_t part_nodes(std::uint32_t count) {
  const std::uint32_t size = part_size(count);
  std::uint32_t nodes = 1;
  if (size > kMostInLeaf) nodes += count / size * part_nodes(size);
  if (count % size > kMostInLeaf) nodes += part_nodes(count % size);
  return nodes;
}

// Which kd nodes become the roots of wide nodes: from the leaves up, a subtree is closed when it
// and its sibling have more than 16 children together. The larger one has 9 or more then, so wide
// nodes are more than half full. Returns the number of wide nodes; they are numbered in pre-order.
std::uint32_t choose_wide_roots(std::span<const Node> nodes, WideScratch& scratch) {
  std::vector<std::uint8_t>& units = scratch.units;
  std::vector<std::uint32_t>& wide_of = scratch.wide_of;
  units.resize(nodes.size());
  wide_of.assign(nodes.size(), kNotWide);
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const Node node = nodes[i];
    if (node.is_leaf()) {
      units[i] = 1;
      if (node.count() > kMostInLeaf) wide_of[i] = 0;
      continue;
    }
    std::uint32_t lower = static_cast<std::uint32_t>(i) + 1, upper = node.upper();
    if (units[lower] < units[upper]) std::swap(lower, upper);
    std::uint32_t sum = units[lower] + units[upper];
    if (sum > kWide) {
      wide_of[lower] = 0;
      sum = units[upper] + 1u;
      if (sum > kWide) {
        wide_of[upper] = 0;
        sum = 2;
      }
    }
    units[i] = static_cast<std::uint8_t>(sum);
  }
  wide_of[0] = 0;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (wide_of[i] == kNotWide) continue;
    wide_of[i] = count;
    count += nodes[i].is_leaf() ? part_nodes(nodes[i].count()) : 1;
  }
  return count;
}

class LayoutMaker {
 public:
  LayoutMaker(const Tree& tree, const MeshView& mesh, WideLayout& layout,
              const WideScratch& scratch)
      : nodes_(tree.nodes()), wide_of_(scratch.wide_of), layout_(layout), fill_(mesh) {}

  // Makes the wide node of the kd node `root`, whose cell is `cell`, and all under it; returns the
  // box round them.
  Box3 make(std::uint32_t root, const Box3& cell, int level) {
    if (nodes_[root].is_leaf()) return make_leaf_parts(root, cell);
    Treelet treelet;
    collect(root, cell, treelet);
    WideNode& wide = layout_.nodes[wide_of_[root]];
    clear(wide);
    set_order(treelet, wide);
    std::array<Box3, kWide> boxes;
    if (level < 2 && nodes_.size() > 2 * kNodesPerTask) {
      tbb::task_group tasks;
      for (std::uint32_t c = 0; c < treelet.children; ++c) {
        tasks.run([&, c] { boxes[c] = make_child(treelet.child[c], wide, c, level); });
      }
      tasks.wait();
    } else {
      for (std::uint32_t c = 0; c < treelet.children; ++c) {
        boxes[c] = make_child(treelet.child[c], wide, c, level);
      }
    }
    return set_bounds(wide, {boxes.data(), treelet.children});
  }

 private:
  struct Child {
    std::uint32_t node = 0;
    Box3 cell;
  };
  // The kd nodes inside one wide node: inner ones by number, children as ~number.
  struct Treelet {
    struct Inner {
      std::uint32_t axis;
      std::int32_t lower, upper;
    };
    std::array<Inner, kWide> inner;
    std::array<Child, kWide> child;
    std::uint32_t inners = 0;
    std::uint32_t children = 0;
  };

  std::int32_t collect(std::uint32_t index, const Box3& cell, Treelet& treelet) {
    const Node node = nodes_[index];
    if (node.is_leaf() || (wide_of_[index] != kNotWide && treelet.inners > 0)) {
      treelet.child[treelet.children] = {index, cell};
      return ~static_cast<std::int32_t>(treelet.children++);
    }
    const std::uint32_t self = treelet.inners++;
    Box3 part = cell;
    part.hi[node.axis()] = node.split();
    const std::int32_t lower = collect(index + 1, part, treelet);
    part.hi[node.axis()] = cell.hi[node.axis()];
    part.lo[node.axis()] = node.split();
    const std::int32_t upper = collect(node.upper(), part, treelet);
    treelet.inner[self] = {node.axis(), lower, upper};
    return static_cast<std::int32_t>(self);
  }

  static void walk(const Treelet& treelet, std::int32_t at, std::uint32_t octant,
                   std::uint64_t& order, int& place) {
    if (at < 0) {
      order |= static_cast<std::uint64_t>(~at) << (4 * place++);
      return;
    }
    const auto& inner = treelet.inner[static_cast<std::size_t>(at)];
    const bool down = (octant >> inner.axis & 1) != 0;
    walk(treelet, down ? inner.upper : inner.lower, octant, order, place);
    walk(treelet, down ? inner.lower : inner.upper, octant, order, place);
  }

  // The slots without a child come last; nobody sees them.
  static void set_order(const Treelet& treelet, WideNode& wide) {
    for (std::uint32_t octant = 0; octant < 4; ++octant) {
      std::uint64_t order = 0;
      int place = 0;
      walk(treelet, 0, octant, order, place);
      for (std::uint64_t c = treelet.children; c < kWide; ++c) order |= c << (4 * place++);
      wide.order[octant] = order;
    }
  }

  Box3 make_child(const Child& child, WideNode& wide, std::uint32_t slot, int level) {
    const Node node = nodes_[child.node];
    if (wide_of_[child.node] != kNotWide) {
      wide.child[slot] = wide_of_[child.node];
      return make(child.node, child.cell, level + 1);
    }
    wide.child[slot] = node.first();
    wide.count[slot] = static_cast<std::uint8_t>(node.count());
    return make_leaf(node.first(), node.count(), child.cell);
  }

  Box3 make_leaf(std::uint32_t first, std::uint32_t count, const Box3& cell) {
    if (count == 0) return {};
    Box3 box = fill_(layout_.ids.subspan(first, count),
                     layout_.triangles.data() + std::size_t{kTriangleRows} * first);
    for (std::size_t a = 0; a < 3; ++a) {
      // Where nothing of a triangle's box is in the cell (a touch), the box is the touched side.
      box.lo[a] = std::min(std::max(box.lo[a], cell.lo[a]), cell.hi[a]);
      box.hi[a] = std::max(std::min(box.hi[a], cell.hi[a]), cell.lo[a]);
    }
    return box;
  }

  // A leaf of the kd-tree with more triangles than a child may have, or the root of a tree that is
  // one leaf: parts of it under as many levels of nodes as they need.
  Box3 make_leaf_parts(std::uint32_t leaf, const Box3& cell) {
    const Node node = nodes_[leaf];
    std::uint32_t next = wide_of_[leaf];
    return make_parts(node.first(), node.count(), cell, next);
  }

  Box3 make_parts(std::uint32_t first, std::uint32_t count, const Box3& cell, std::uint32_t& next) {
    WideNode& wide = layout_.nodes[next++];
    clear(wide);
    std::fill_n(wide.order, 4, 0xfedcba9876543210u);
    const std::uint32_t size = part_size(count);
    std::array<Box3, kWide> boxes;
    std::uint32_t children = 0;
    for (std::uint32_t done = 0; done < count; done += size, ++children) {
      const std::uint32_t n = std::min(size, count - done);
      if (n > kMostInLeaf) {
        wide.child[children] = next;
        boxes[children] = make_parts(first + done, n, cell, next);
      } else {
        wide.child[children] = first + done;
        wide.count[children] = static_cast<std::uint8_t>(n);
        boxes[children] = make_leaf(first + done, n, cell);
      }
    }
    return set_bounds(wide, {boxes.data(), children});
  }

  static void clear(WideNode& wide) {
    std::fill_n(&wide.bound[0][0][0], 3 * kWide, kInfinity);
    std::fill_n(&wide.bound[1][0][0], 3 * kWide, -kInfinity);
    std::memset(wide.child, 0, sizeof wide.child);
    std::memset(wide.count, 0, sizeof wide.count);
    wide.unused.fill(0);
  }

  Box3 set_bounds(WideNode& wide, std::span<const Box3> boxes) const {
    Box3 all;
    for (std::size_t c = 0; c < boxes.size(); ++c) {
      if (boxes[c].lo.x > boxes[c].hi.x) continue;  // nothing in it
      all.include(boxes[c].lo);
      all.include(boxes[c].hi);
      for (std::size_t a = 0; a < 3; ++a) {
        wide.bound[0][a][c] = boxes[c].lo[a] - layout_.centre[a];
        wide.bound[1][a][c] = boxes[c].hi[a] - layout_.centre[a];
      }
    }
    return all;
  }

  std::span<const Node> nodes_;
  const std::vector<std::uint32_t>& wide_of_;
  WideLayout& layout_;
  LeafTriangles fill_;
};

}  // namespace

void make_wide_layout(const Tree& tree, const MeshView& mesh, WideLayout& layout,
                      WideScratch& scratch) {
  const Box3& bounds = tree.info().bounds;
  layout.centre = bounds.lo * 0.5f + bounds.hi * 0.5f;
  layout.ids = tree.ids();
  layout.nodes.resize_and_forget(choose_wide_roots(tree.nodes(), scratch));
  layout.triangles.resize_and_forget(kTriangleRows * tree.ids().size() + kWide);
  LayoutMaker(tree, mesh, layout, scratch).make(0, bounds, 0);
}

}  // namespace fasttree
