// SPDX-License-Identifier: Apache-2.0
#include "trace/wide_layout.h"

#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <limits>

#include "trace/leaf_triangles.h"

namespace fasttree {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Subtrees with fewer kd nodes are not worth a task of their own.
constexpr std::size_t kNodesPerTask = 512;

// Room for the wide nodes of a tree. One with 16 leaves or more under it has 16 children, so at
// worst 16 of 17 have two leaves; large leaves have a node a part at worst.
std::size_t most_wide_nodes(const Tree& tree) {
  return tree.leaf_count() * 9 / 16 + tree.ids().size() / kMostInLeaf + 2;
}

// What stands for the chance that a ray meets a box.
float half_area(const Box3& box) {
  const Vec3 e = box.extent();
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

class LayoutMaker {
 public:
  LayoutMaker(const Tree& tree, const MeshView& mesh, WideLayout& layout)
      : nodes_(tree.nodes()), layout_(layout), fill_(mesh, tree.ids()) {}

  std::uint32_t nodes_used() const { return next_; }

  // Makes a wide node for the kd nodes [root, end), whose cell is `cell`, and all under it; returns
  // its index and the box round them.
  struct Made {
    std::uint32_t index;
    Box3 box;
  };
  Made make(std::uint32_t root, std::uint32_t end, const Box3& cell) {
    if (nodes_[root].is_leaf()) return make_parts(nodes_[root].first(), nodes_[root].count(), cell);
    Treelet treelet;
    open(root, end, cell, treelet);
    const std::uint32_t index = next_.fetch_add(1, std::memory_order_relaxed);
    WideNode& wide = layout_.nodes[index];
    clear(wide);
    set_order(treelet, wide);
    std::array<Box3, kWide> boxes;
    if (end - root > 2 * kNodesPerTask) {
      tbb::task_group tasks;
      for (std::uint32_t c = 0; c < treelet.children; ++c) {
        tasks.run([&, c] { boxes[c] = make_child(treelet.child[c], wide, c); });
      }
      tasks.wait();
    } else {
      for (std::uint32_t c = 0; c < treelet.children; ++c) {
        boxes[c] = make_child(treelet.child[c], wide, c);
      }
    }
    return {index, set_bounds(wide, {boxes.data(), treelet.children})};
  }

 private:
  struct Child {
    std::uint32_t node = 0;  // of the kd-tree; those under it end before `end`
    std::uint32_t end = 0;
    Box3 cell;
    float worth = 0;               // of being opened; a leaf has none
    std::int32_t* link = nullptr;  // to it, in the treelet
  };
  // The kd nodes inside one wide node: inner ones by number, children as ~number.
  struct Treelet {
    struct Inner {
      std::uint32_t axis;
      std::int32_t side[2];
    };
    std::array<Inner, kWide> inner;
    std::array<Child, kWide> child;
    std::int32_t root = ~0;
    std::uint32_t inners = 0;
    std::uint32_t children = 1;
  };

  // The child whose cell a ray meets most often is replaced by its two sides, until there are 16.
  // Subtrees that would become half-empty nodes when opened are left whole, so that they fill a
  // node of their own.
  void open(std::uint32_t root, std::uint32_t end, const Box3& cell, Treelet& treelet) const {
    treelet.child[0] = {root, end, cell, 1.0f, &treelet.root};
    while (treelet.children < kWide) {
      std::uint32_t c = 0;
      float most = 0;
      const std::uint32_t room = kWide - treelet.children + 1;
      for (std::uint32_t i = 0; i < treelet.children; ++i) {
        const std::uint32_t leaves = (treelet.child[i].end - treelet.child[i].node + 1) / 2;
        const bool whole = leaves <= kWide && leaves > room;
        const float worth = treelet.child[i].worth * (whole ? 1e-3f : 1.0f);
        if (worth > most) {
          most = worth;
          c = i;
        }
      }
      if (most == 0) return;
      Child& opened = treelet.child[c];
      const Node node = nodes_[opened.node];
      const auto m = static_cast<std::int32_t>(treelet.inners++);
      auto& inner = treelet.inner[static_cast<std::size_t>(m)];
      *opened.link = m;
      const std::uint32_t k = treelet.children++;
      inner = {node.axis(), {~static_cast<std::int32_t>(c), ~static_cast<std::int32_t>(k)}};
      Child& upper = treelet.child[k];
      upper = {node.upper(), opened.end, opened.cell, 0, &inner.side[1]};
      upper.cell.lo[node.axis()] = node.split();
      opened.end = node.upper();
      opened.node += 1;
      opened.cell.hi[node.axis()] = node.split();
      opened.link = &inner.side[0];
      for (Child* side : {&opened, &upper}) {
        // Flat cells have no area and are opened all the same.
        side->worth = nodes_[side->node].is_leaf()
                          ? 0.0f
                          : half_area(side->cell) + std::numeric_limits<float>::min();
      }
    }
  }

  static void walk(const Treelet& treelet, std::int32_t at, std::uint32_t octant,
                   std::uint64_t& order, int& place) {
    if (at < 0) {
      order |= static_cast<std::uint64_t>(~at) << (4 * place++);
      return;
    }
    const auto& inner = treelet.inner[static_cast<std::size_t>(at)];
    const bool down = (octant >> inner.axis & 1) != 0;
    walk(treelet, inner.side[down], octant, order, place);
    walk(treelet, inner.side[!down], octant, order, place);
  }

  // The slots without a child come last; nobody sees them.
  static void set_order(const Treelet& treelet, WideNode& wide) {
    for (std::uint32_t octant = 0; octant < 4; ++octant) {
      std::uint64_t order = 0;
      int place = 0;
      walk(treelet, treelet.root, octant, order, place);
      for (std::uint64_t c = treelet.children; c < kWide; ++c) order |= c << (4 * place++);
      wide.order[octant] = order;
    }
  }

  Box3 make_child(const Child& child, WideNode& wide, std::uint32_t slot) {
    const Node node = nodes_[child.node];
    if (node.is_leaf() && node.count() <= kMostInLeaf) {
      wide.child[slot] = node.first();
      wide.count[slot] = static_cast<std::uint8_t>(node.count());
      return make_leaf(node.first(), node.count(), child.cell);
    }
    const Made made = make(child.node, child.end, child.cell);
    wide.child[slot] = made.index;
    return made.box;
  }

  Box3 make_leaf(std::uint32_t first, std::uint32_t count, const Box3& cell) {
    if (count == 0) return {};
    Box3 box = fill_(first, count, layout_.triangles.data() + std::size_t{kTriangleRows} * first);
    for (std::size_t a = 0; a < 3; ++a) {
      // Where nothing of a triangle's box is in the cell (a touch), the box is the touched side.
      box.lo[a] = std::min(std::max(box.lo[a], cell.lo[a]), cell.hi[a]);
      box.hi[a] = std::max(std::min(box.hi[a], cell.hi[a]), cell.lo[a]);
    }
    return box;
  }

  // A leaf of the kd-tree with more triangles than a child may have, or the root of a tree that is
  // one leaf: parts of it under as many levels of nodes as they need.
  Made make_parts(std::uint32_t first, std::uint32_t count, const Box3& cell) {
    const std::uint32_t index = next_.fetch_add(1, std::memory_order_relaxed);
    WideNode& wide = layout_.nodes[index];
    clear(wide);
    std::fill_n(wide.order, 4, 0xfedcba9876543210u);
    std::uint64_t size = kMostInLeaf;  // of a child
    while (size * kWide < count) size *= kWide;
    std::array<Box3, kWide> boxes;
    std::uint32_t children = 0;
    for (std::uint64_t done = 0; done < count; done += size, ++children) {
      const auto begin = static_cast<std::uint32_t>(first + done);
      const auto n = static_cast<std::uint32_t>(std::min(size, count - done));
      if (n > kMostInLeaf) {
        const Made made = make_parts(begin, n, cell);
        wide.child[children] = made.index;
        boxes[children] = made.box;
      } else {
        wide.child[children] = begin;
        wide.count[children] = static_cast<std::uint8_t>(n);
        boxes[children] = make_leaf(begin, n, cell);
      }
    }
    return {index, set_bounds(wide, {boxes.data(), children})};
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
  WideLayout& layout_;
  std::atomic<std::uint32_t> next_ = 0;
  LeafTriangles fill_;
};

}  // namespace

void make_wide_layout(const Tree& tree, const MeshView& mesh, WideLayout& layout) {
  const Box3& bounds = tree.info().bounds;
  layout.centre = bounds.lo * 0.5f + bounds.hi * 0.5f;
  layout.ids = tree.ids();
  layout.nodes.resize_and_forget(most_wide_nodes(tree));
  layout.triangles.resize_and_forget(kTriangleRows * tree.ids().size() + kWide);
  // The root comes first, as it is made before all that is under it.
  LayoutMaker maker(tree, mesh, layout);
  maker.make(0, static_cast<std::uint32_t>(tree.nodes().size()), bounds);
  layout.node_count = maker.nodes_used();
}

}  // namespace fasttree
