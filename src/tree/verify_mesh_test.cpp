// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "fasttree/verify.h"
#include "tree/test_trees.h"

namespace fasttree {
namespace {

using test::Mesh;
using test::Rng;

// Triangles shrunk to a corner each would be boring: these span a little on all axes.
void add_triangle(Mesh& mesh, Vec3 at, Vec3 size) {
  mesh.corners.push_back(at);
  mesh.corners.push_back(at + Vec3{size.x, 0, size.z});
  mesh.corners.push_back(at + Vec3{0, size.y, 0});
}

struct Sample {
  Mesh mesh;
  Tree tree;

  Verification verify() const { return fasttree::verify(tree, mesh.view()); }
};

TEST(VerifyMesh, GoodTreesPass) {
  EXPECT_TRUE((Sample{{}, Tree()}.verify().ok));
  ASSERT_TRUE(rc::check([](std::uint64_t seed) {
    Rng rng(seed);
    const Mesh mesh = test::random_mesh(rng, *rc::gen::inRange<std::uint32_t>(0, 60));
    const int depth = *rc::gen::inRange(0, 13);
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      const Tree tree = test::plain_paper_tree(mesh, axes, depth);
      const Verification v = verify(tree, mesh.view());
      RC_ASSERT(v.invariant == "");
      RC_ASSERT(v.checks > verify(tree).checks);
    }
    const Verification v = verify(test::plain_box_tree(mesh, rng, depth), mesh.view());
    RC_ASSERT(v.invariant == "");
  }));
}

// Far from the origin several planes of an axis are the same number, and cells between them hold
// no number at all but are in a triangle's box none the less.
TEST(VerifyMesh, CoincidentPlanesPass) {
  for (const float offset : {1e4f, 1e5f, 1e6f}) {
    Rng rng(3);
    Mesh mesh = test::random_mesh(rng, 50);
    for (Vec3& p : mesh.corners) p = p + Vec3{offset, -offset, offset};
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      const Sample s{mesh, test::plain_paper_tree(mesh, axes, 12)};
      const Verification v = s.verify();
      EXPECT_TRUE(v.ok) << v.invariant << ": " << v.detail;
    }
    const Verification v = verify(test::plain_box_tree(mesh, rng, 8), mesh.view());
    EXPECT_TRUE(v.ok) << v.invariant << ": " << v.detail;
  }
}

TEST(VerifyMesh, FlatMeshesPass) {
  for (std::size_t dead = 0; dead < 8; ++dead) {
    Rng rng(4);
    Mesh mesh = test::random_mesh(rng, 30);
    for (Vec3& p : mesh.corners) {
      for (std::size_t a = 0; a < 3; ++a) {
        if (dead >> a & 1) p[a] = 0.5f;
      }
    }
    const Verification v =
        verify(test::plain_paper_tree(mesh, AxisSchedule::cyclic, 9), mesh.view());
    EXPECT_TRUE(v.ok) << dead << " " << v.invariant << ": " << v.detail;
  }
}

Sample paper_sample() {
  Rng rng(5);
  const Mesh mesh = test::random_mesh(rng, 40);
  return {mesh, test::plain_paper_tree(mesh, AxisSchedule::cyclic, 9)};
}

Sample box_sample() {
  Rng rng(6);
  const Mesh mesh = test::random_mesh(rng, 40);
  return {mesh, test::plain_box_tree(mesh, rng, 6)};
}

// Four small triangles, one in each corner of the unit square's 2 x 2 cells, without the cell in
// the middle of nowhere: planes x = 1/2 and y = 1/2.
Sample corners_sample() {
  Mesh mesh;
  for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{0, 0.9f, 0}, Vec3{0.9f, 0.9f, 0}}) {
    add_triangle(mesh, at, {0.1f, 0.1f, 0});
  }
  return {mesh, test::plain_paper_tree(mesh, AxisSchedule::cyclic, 2)};
}

Tree with_nodes(const Tree& tree, const std::vector<Node>& nodes) {
  return Tree(tree.info(), nodes, test::ids_of(tree));
}

struct Breakage {
  const char* invariant;
  const char* how;
  Sample (*sample)();
  std::function<void(Sample&)> damage;
};

std::vector<Breakage> breakages() {
  using S = Sample&;
  return {
      {"mesh", "not a number", paper_sample,
       [](S s) { s.mesh.corners[7].y = std::numeric_limits<float>::quiet_NaN(); }},
      {"mesh-triangle-count", "one more", paper_sample,
       [](S s) {
         add_triangle(s.mesh, {1, 1, 0.5f}, {0.1f, 0.1f, 0.1f});
       }},
      {"mesh-bounds", "a corner outside", paper_sample, [](S s) { s.mesh.corners[3].z = 1.5f; }},
      {"reference-count", "another mesh in the same bounds", corners_sample,
       [](S s) { s.mesh.corners[1].x = 0.7f; }},
      {"leaf-cells", "triangles exchanged", corners_sample,
       [](S s) {
         for (std::size_t i = 0; i < 3; ++i) std::swap(s.mesh.corners[i], s.mesh.corners[3 + i]);
       }},
      {"leaf-cells", "two cells in one leaf", corners_sample,
       [](S s) {
         const Node root = s.tree.nodes()[0];
         s.tree = with_nodes(s.tree, {Node::inner(root.axis(), root.split(), 2), Node::leaf(0, 2),
                                      Node::leaf(2, 1)});
       }},
      {"leaf-cells", "one cell in two leaves",
       [] {
         Mesh mesh;
         add_triangle(mesh, {0, 0, 0}, {0.1f, 0.1f, 0});
         add_triangle(mesh, {0.1f, 0.1f, 0}, {0.1f, 0.1f, 0});
         add_triangle(mesh, {0.9f, 0.9f, 0}, {0.1f, 0.1f, 0});
         return Sample{mesh, test::plain_paper_tree(mesh, AxisSchedule::cyclic, 2)};
       },
       [](S s) {
         const Node root = s.tree.nodes()[0];
         s.tree =
             with_nodes(s.tree, {Node::inner(root.axis(), root.split(), 4), Node::inner(1, 0.5f, 3),
                                 Node::leaf(0, 1), Node::leaf(1, 1), Node::leaf(2, 1)});
       }},
      {"split-plane", "the other axis", corners_sample,
       [](S s) {
         std::vector<Node> nodes = test::nodes_of(s.tree);
         nodes[0] = Node::inner(1, 0.5f, nodes[0].upper());
         s.tree = with_nodes(s.tree, nodes);
       }},
      {"split-plane", "another plane of the same axis", paper_sample,
       [](S s) {
         const Grid grid(s.tree.info().bounds, s.tree.info().axes, s.tree.info().depth);
         std::vector<Node> nodes = test::nodes_of(s.tree);
         for (Node& n : nodes) {  // the last inner node is the easiest to keep in its cell
           if (n.is_leaf() || !n.split()) continue;
           for (std::uint32_t k = 1; k < 1u << grid.bits()[n.axis()]; ++k) {
             const Node moved = Node::inner(n.axis(), grid.plane(n.axis(), k), n.upper());
             const Node old = std::exchange(n, moved);
             if (moved != old && verify(with_nodes(s.tree, nodes)).ok) {
               s.tree = with_nodes(s.tree, nodes);
               return;
             }
             n = old;
           }
         }
       }},
      // x parts the last leaf, y the first two. Turned over, the order of the leaves is the same.
      {"path-compression", "rotated", corners_sample,
       [](S s) {
         const std::vector<Node> n = test::nodes_of(s.tree);
         s.tree = with_nodes(s.tree, {Node::inner(n[1].axis(), n[1].split(), 2), n[2],
                                      Node::inner(n[0].axis(), n[0].split(), 4), n[3], n[4]});
       }},
      {"missing-reference", "dropped from one of its leaves", box_sample,
       [](S s) {
         // The first triangle of the first leaf that has another leaf and reaches clearly into it.
         std::vector<Node> nodes = test::nodes_of(s.tree);
         std::vector<std::uint32_t> ids = test::ids_of(s.tree);
         for (std::size_t at = 0; at < ids.size(); ++at) {
           std::vector<std::uint32_t> fewer = ids;
           fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(at));
           std::vector<Node> moved = nodes;
           for (Node& n : moved) {
             if (!n.is_leaf() || n.first() + n.count() <= at) continue;
             n = n.first() > at ? Node::leaf(n.first() - 1, n.count())
                                : Node::leaf(n.first(), n.count() - 1);
           }
           const Tree tree(s.tree.info(), moved, fewer);
           if (verify(tree).ok && !verify(tree, s.mesh.view()).ok) {
             s.tree = tree;
             return;
           }
         }
       }},
      {"extra-reference", "in a leaf far away", box_sample,
       [](S s) {
         std::vector<Node> nodes = test::nodes_of(s.tree);
         std::vector<std::uint32_t> ids = test::ids_of(s.tree);
         // The last leaf gets the first id that makes the tree wrong.
         for (std::uint32_t id = 0; id < s.mesh.triangle_count(); ++id) {
           const Node last = nodes.back();
           std::set<std::uint32_t> run(ids.begin() + last.first(), ids.end());
           if (!run.insert(id).second) continue;
           std::vector<std::uint32_t> more(ids.begin(), ids.begin() + last.first());
           more.insert(more.end(), run.begin(), run.end());
           std::vector<Node> changed = nodes;
           changed.back() = Node::leaf(last.first(), last.count() + 1);
           const Tree tree(s.tree.info(), changed, more);
           if (!verify(tree, s.mesh.view()).ok) {
             s.tree = tree;
             return;
           }
         }
       }},
      {"extra-reference", "its box touches the cell, it does not",
       [] {
         Mesh mesh;  // a triangle below the diagonal of the unit square; the cell is above it
         mesh.corners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
         TreeInfo info;
         info.profile = Profile::sah_binned;
         info.triangle_count = 1;
         info.bounds = mesh.bounds();
         return Sample{mesh, Tree(info,
                                  {Node::inner(0, 0.25f, 4), Node::inner(1, 0.75f, 3),
                                   Node::leaf(0, 1), Node::leaf(1, 1), Node::leaf(2, 1)},
                                  {0, 0, 0})};
       },
       [](S s) {
         TreeInfo info = s.tree.info();
         info.profile = Profile::sah_exact;
         s.tree = Tree(info, test::nodes_of(s.tree), test::ids_of(s.tree));
       }},
  };
}

TEST(VerifyMesh, EachBreakageIsNamed) {
  std::set<std::string> broken;
  for (const Breakage& b : breakages()) {
    Sample s = b.sample();
    const Verification before = s.verify();
    ASSERT_TRUE(before.ok) << b.how << " " << before.invariant << ": " << before.detail;
    b.damage(s);
    EXPECT_TRUE(verify(s.tree).ok) << b.how << ": only the mesh can tell";
    const Verification v = s.verify();
    EXPECT_FALSE(v.ok) << b.invariant << ", " << b.how;
    EXPECT_EQ(v.invariant, b.invariant) << b.how << ": " << v.detail;
    EXPECT_FALSE(v.detail.empty());
    broken.insert(b.invariant);
  }
  EXPECT_EQ(broken.size(), 9u) << "a new invariant needs its breakage here";
}

TEST(VerifyMesh, BadIndicesAreAMatterOfTheMesh) {
  const Sample s = corners_sample();
  std::vector<std::uint32_t> indices{0, 1, 2, 3, 4, 5, 6, 7, 9};
  MeshView view = s.mesh.view();
  view.indices = indices.data();
  EXPECT_EQ(verify(s.tree, view).invariant, "mesh");
  indices.back() = 8;
  EXPECT_TRUE(verify(s.tree, view).ok);
}

TEST(VerifyMesh, ABrokenTreeIsNamedWithoutItsMesh) {
  const Sample s = box_sample();
  std::vector<Node> nodes = test::nodes_of(s.tree);
  nodes[0] = Node::inner(0, 1e9f, nodes[0].upper());
  EXPECT_EQ(verify(with_nodes(s.tree, nodes), s.mesh.view()).invariant, "split-in-cell");
}

// A triangle in a plane may be on either side of it, but on one.
TEST(VerifyMesh, FlatTrianglesMayBeOnEitherSideOfTheirPlane) {
  Mesh mesh;
  mesh.corners = {{0, 0, 0},    {0, 1, 1}, {0, 0, 1}, {0.5f, 0, 0}, {0.5f, 1, 0},
                  {0.5f, 1, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
  TreeInfo info;
  info.profile = Profile::sah_exact;
  info.triangle_count = 3;
  info.bounds = mesh.bounds();
  const auto with_runs = [&](std::uint32_t lower, std::uint32_t upper,
                             const std::vector<std::uint32_t>& ids) {
    const Tree tree(info, {Node::inner(0, 0.5f, 2), Node::leaf(0, lower), Node::leaf(lower, upper)},
                    ids);
    return verify(tree, mesh.view()).invariant;
  };
  EXPECT_EQ(with_runs(2, 1, {0, 1, 2}), "");
  EXPECT_EQ(with_runs(1, 2, {0, 1, 2}), "");
  EXPECT_EQ(with_runs(2, 2, {0, 1, 1, 2}), "");
  EXPECT_EQ(with_runs(1, 3, {0, 0, 1, 2}), "extra-reference");
  EXPECT_EQ(with_runs(2, 1, {1, 2, 0}), "missing-reference");
}

// Points of triangles, found in the tree by their coordinates, against the verdict: a tree that
// passes has every point in a leaf that lists its triangle.
TEST(VerifyMesh, VerdictAgreesWithPointsOfTheTriangles) {
  Rng rng(23);
  int passed = 0;
  int failed = 0;
  for (int round = 0; round < 300; ++round) {
    const Mesh mesh = test::random_mesh(rng, 12);
    const Tree good = test::plain_box_tree(mesh, rng, 5);
    // Drop one id here and there.
    std::vector<Node> nodes = test::nodes_of(good);
    std::vector<std::uint32_t> ids;
    for (Node& n : nodes) {
      if (!n.is_leaf()) continue;
      const std::size_t first = ids.size();
      for (const std::uint32_t id : good.ids().subspan(n.first(), n.count())) {
        if (test::below(rng, 60) != 0) ids.push_back(id);
      }
      n = Node::leaf(static_cast<std::uint32_t>(first),
                     static_cast<std::uint32_t>(ids.size() - first));
    }
    const Tree tree(good.info(), nodes, ids);
    if (!verify(tree).ok) continue;  // dropped from its only leaf
    const bool verdict = verify(tree, mesh.view()).ok;
    bool points = true;
    for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      const auto corners = mesh.view().triangle(t);
      for (int sample = 0; sample < 300; ++sample) {
        double u = test::between(rng, 0, 1);
        double v = test::between(rng, 0, 1);
        if (u + v > 1) {
          u = 1 - u;
          v = 1 - v;
        }
        bool near_a_plane = false;
        std::uint32_t index = 0;
        while (!nodes[index].is_leaf()) {
          const std::size_t a = nodes[index].axis();
          const double p = corners[0][a] + u * (corners[1][a] - corners[0][a]) +
                           v * (corners[2][a] - corners[0][a]);
          near_a_plane |= std::fabs(p - nodes[index].split()) < 1e-4;
          index = p >= nodes[index].split() ? nodes[index].upper() : index + 1;
        }
        const auto run = std::span(ids).subspan(nodes[index].first(), nodes[index].count());
        if (!near_a_plane && !std::ranges::binary_search(run, t)) points = false;
      }
    }
    EXPECT_TRUE(points || !verdict) << "round " << round;
    (verdict ? passed : failed) += 1;
  }
  EXPECT_GT(passed, 30);
  EXPECT_GT(failed, 30);
}

// Links, planes and ids changed at random, with the mesh at hand: whatever differs from the one
// tree that the definition gives is found.
TEST(VerifyMesh, OnlyTheOneTreePasses) {
  Rng rng(29);
  const Sample sample = paper_sample();
  for (int round = 0; round < 5000; ++round) {
    std::vector<Node> nodes = test::nodes_of(sample.tree);
    std::vector<std::uint32_t> ids = test::ids_of(sample.tree);
    Node& node = nodes[test::below(rng, static_cast<std::uint32_t>(nodes.size()))];
    switch (test::below(rng, 4)) {
      case 0:
        node.word0 ^= 1u << test::below(rng, 12);
        break;
      case 1:
        node.word1 ^= 1u << test::below(rng, 32);
        break;
      case 2:
        node = nodes[test::below(rng, static_cast<std::uint32_t>(nodes.size()))];
        break;
      default:
        ids[test::below(rng, static_cast<std::uint32_t>(ids.size()))] =
            test::below(rng, sample.mesh.triangle_count());
    }
    const Tree tree(sample.tree.info(), nodes, ids);
    ASSERT_EQ(verify(tree, sample.mesh.view()).ok, test::same(tree, sample.tree)) << round;
  }
}

}  // namespace
}  // namespace fasttree
