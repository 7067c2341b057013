// SPDX-License-Identifier: Apache-2.0
#include "trace/wide_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <vector>

#include "fasttree/build.h"
#include "tests/support/meshes.h"

namespace fasttree {
namespace {

using test::OwnedMesh;

struct Range {
  std::uint32_t first, count;
};

// A walk over all that can be reached from the root.
class Walker {
 public:
  Walker(const WideLayout& layout, const MeshView& mesh) : layout_(layout), mesh_(mesh) {}

  std::vector<Range> leaves;
  std::uint32_t nodes = 0;

  void walk(std::uint32_t index) {
    ASSERT_LT(index, layout_.node_count);
    ++nodes;
    const WideNode& node = layout_.nodes[index];
    for (const std::uint64_t order : node.order) {
      std::uint32_t seen = 0;
      for (std::uint32_t place = 0; place < kWide; ++place) seen |= 1u << (order >> 4 * place & 15);
      ASSERT_EQ(seen, 0xffffu);
    }
    for (std::uint32_t c = 0; c < kWide; ++c) {
      const std::uint32_t n = node.count[c];
      // Slots without a child and with an empty leaf have a box that nothing hits.
      if (node.bound[0][0][c] > node.bound[1][0][c]) {
        ASSERT_EQ(n, 0u);
        continue;
      }
      for (std::size_t a = 0; a < 3; ++a) ASSERT_LE(node.bound[0][a][c], node.bound[1][a][c]);
      if (n == 0) {
        ASSERT_GT(node.child[c], index);  // made after the node above it
        contains_children(node, c, layout_.nodes[node.child[c]]);
        walk(node.child[c]);
        if (testing::Test::HasFatalFailure()) return;
        continue;
      }
      ASSERT_LE(n, kMostInLeaf);
      leaves.push_back({node.child[c], n});
      check_rows(node.child[c], n);
    }
  }

 private:
  static void contains_children(const WideNode& node, std::uint32_t c, const WideNode& under) {
    for (std::uint32_t k = 0; k < kWide; ++k) {
      if (under.bound[0][0][k] > under.bound[1][0][k]) continue;
      for (std::size_t a = 0; a < 3; ++a) {
        ASSERT_LE(node.bound[0][a][c], under.bound[0][a][k]);
        ASSERT_GE(node.bound[1][a][c], under.bound[1][a][k]);
      }
    }
  }

  void check_rows(std::uint32_t first, std::uint32_t n) const {
    const float* const rows = layout_.triangles_of(first);
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto triangle = mesh_.triangle(layout_.ids[first + i]);
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t a = 0; a < 3; ++a) {
          ASSERT_EQ(std::bit_cast<std::uint32_t>(rows[(3 * c + a) * n + i]),
                    std::bit_cast<std::uint32_t>(triangle[c][a]));
        }
      }
    }
  }

  const WideLayout& layout_;
  const MeshView& mesh_;
};

// The kd-tree's leaves with their cells, by first reference.
void cells_of(const Tree& tree, std::uint32_t index, const Box3& cell,
              std::vector<std::pair<Range, Box3>>& cells) {
  const Node node = tree.nodes()[index];
  if (node.is_leaf()) {
    if (node.count() != 0) cells.push_back({{node.first(), node.count()}, cell});
    return;
  }
  Box3 lower = cell, upper = cell;
  lower.hi[node.axis()] = upper.lo[node.axis()] = node.split();
  cells_of(tree, index + 1, lower, cells);
  cells_of(tree, node.upper(), upper, cells);
}

// Each leaf's box holds what of its triangles' boxes is in its cell.
void check_leaf_boxes(const WideLayout& layout, const Tree& tree, const MeshView& mesh) {
  std::vector<std::pair<Range, Box3>> cells;
  cells_of(tree, 0, tree.info().bounds, cells);
  std::ranges::sort(cells, {}, [](const auto& entry) { return entry.first.first; });
  for (std::uint32_t i = 0; i < layout.node_count; ++i) {
    const WideNode& node = layout.nodes[i];
    for (std::uint32_t c = 0; c < kWide; ++c) {
      const std::uint32_t first = node.child[c], n = node.count[c];
      if (n == 0) continue;
      auto at = std::ranges::upper_bound(cells, first, {},
                                         [](const auto& entry) { return entry.first.first; });
      ASSERT_NE(at, cells.begin());
      --at;
      ASSERT_LE(first + n, at->first.first + at->first.count);
      for (std::uint32_t r = first; r < first + n; ++r) {
        Box3 box;
        for (const Vec3& p : mesh.triangle(layout.ids[r])) box.include(p);
        for (std::size_t a = 0; a < 3; ++a) {
          const float lo = std::max(box.lo[a], at->second.lo[a]);
          const float hi = std::min(box.hi[a], at->second.hi[a]);
          if (lo > hi) continue;
          ASSERT_LE(node.bound[0][a][c], lo - layout.centre[a]);
          ASSERT_GE(node.bound[1][a][c], hi - layout.centre[a]);
        }
      }
    }
  }
}

// An order has, at each plane of the kd-tree, the side first that a ray of the octant meets first:
// children that are apart on one axis tell, where they are apart on one only.
void check_order(const WideLayout& layout) {
  for (std::uint32_t i = 0; i < layout.node_count; ++i) {
    const WideNode& node = layout.nodes[i];
    for (std::uint32_t octant = 0; octant < 4; ++octant) {
      for (std::uint32_t p = 0; p < kWide; ++p) {
        const auto c = static_cast<std::uint32_t>(node.order[octant] >> 4 * p & 15);
        if (node.bound[0][0][c] > node.bound[1][0][c]) continue;
        for (std::uint32_t q = p + 1; q < kWide; ++q) {
          const auto k = static_cast<std::uint32_t>(node.order[octant] >> 4 * q & 15);
          if (node.bound[0][0][k] > node.bound[1][0][k]) continue;
          // Where c lies wholly behind k on an axis, it must lie before it on another.
          bool behind = false, before = false;
          for (std::uint32_t a = 0; a < 3; ++a) {
            const bool c_above = node.bound[0][a][c] >= node.bound[1][a][k];
            const bool c_below = node.bound[1][a][c] <= node.bound[0][a][k];
            const bool down = (octant >> a & 1) != 0;
            if (c_above && c_below) before = true;  // both flat, in one plane
            if (c_above == c_below) continue;
            (c_above == down ? before : behind) = true;
          }
          ASSERT_TRUE(before || !behind) << "node " << i << " octant " << octant;
        }
      }
    }
  }
}

void check_layout(const WideLayout& layout, const Tree& tree, const MeshView& mesh) {
  ASSERT_LE(layout.node_count, layout.nodes.size());
  Walker walker(layout, mesh);
  walker.walk(0);
  if (testing::Test::HasFatalFailure()) return;
  EXPECT_LE(walker.nodes, layout.node_count);
  std::ranges::sort(walker.leaves, {}, &Range::first);
  std::uint32_t end = 0;
  for (const Range& leaf : walker.leaves) {
    ASSERT_EQ(leaf.first, end);
    end += leaf.count;
  }
  ASSERT_EQ(end, tree.ids().size());
  check_leaf_boxes(layout, tree, mesh);
}

Tree built(const MeshView& mesh, Profile profile) {
  BuildSettings settings;
  settings.profile = profile;
  return Builder().build(mesh, settings).value();
}

const std::vector<Profile> kProfiles{Profile::paper, Profile::realtime, Profile::sah_exact,
                                     Profile::sah_binned};

TEST(WideLayout, CoversEveryReferenceOnce) {
  std::vector<test::NamedMesh> meshes = test::degenerate_meshes();
  meshes.push_back({"soup", test::soup(5000, 1, 0.03f)});
  meshes.push_back({"sheet", test::sheet(40, 0.2f)});
  // One layout for all: what is left in its memory must not be seen.
  WideLayout layout;
  for (const auto& [name, owned] : meshes) {
    for (const Profile profile : kProfiles) {
      SCOPED_TRACE(name + " " + to_string(profile));
      const MeshView mesh = owned.view();
      const Tree tree = built(mesh, profile);
      make_wide_layout(tree, mesh, layout);
      check_layout(layout, tree, mesh);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(WideLayout, HasChildrenFromFrontToBack) {
  for (const OwnedMesh& owned : {test::soup(5000, 1, 0.003f), test::sheet(40, 0.2f)}) {
    for (const Profile profile : kProfiles) {
      SCOPED_TRACE(to_string(profile));
      const Tree tree = built(owned.view(), profile);
      WideLayout layout;
      make_wide_layout(tree, owned.view(), layout);
      check_order(layout);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(WideLayout, LargeLeavesBecomeParts) {
  for (const int count : {239, 240, 241, 480, 3839, 3840, 3841, 4200, 62000}) {
    SCOPED_TRACE(count);
    OwnedMesh owned;
    for (int i = 0; i < count; ++i) owned.add({0, 0, 0}, {1, 0, 0.5f}, {0, 1, 0.25f});
    const MeshView mesh = owned.view();
    for (const Profile profile : {Profile::paper, Profile::realtime}) {
      const Tree tree = built(mesh, profile);
      WideLayout layout;
      make_wide_layout(tree, mesh, layout);
      check_layout(layout, tree, mesh);
      if (HasFatalFailure()) return;
    }
  }
}

// Strides, alignments, with and without indices; nothing past the last position is read.
TEST(WideLayout, ReadsPositionsOfAnyStrideAndAlignment) {
  const OwnedMesh owned = test::soup(301, 4, 0.1f);
  const Tree tree = built(owned.view(), Profile::realtime);
  std::vector<std::uint32_t> indices(owned.positions.size());
  for (std::uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
  for (const std::size_t stride : {12, 13, 16, 20, 31}) {
    for (const std::size_t offset : {0, 1, 4}) {
      const std::size_t n = owned.positions.size();
      // Exactly as long as it has to be, so that a sanitizer sees a read past the end.
      std::vector<std::byte> bytes(offset + (n - 1) * stride + sizeof(Vec3));
      for (std::size_t i = 0; i < n; ++i) {
        std::memcpy(&bytes[offset + i * stride], &owned.positions[i], sizeof(Vec3));
      }
      MeshView mesh = owned.view();
      mesh.positions = bytes.data() + offset;
      mesh.position_stride_bytes = stride;
      for (const bool indexed : {false, true}) {
        mesh.indices = indexed ? indices.data() : nullptr;
        WideLayout layout;
        make_wide_layout(tree, mesh, layout);
        check_layout(layout, tree, owned.view());
        if (HasFatalFailure()) return;
      }
    }
  }
}

}  // namespace
}  // namespace fasttree
