// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "fasttree/device_image.h"
#include "fasttree/verify.h"
#include "tree/test_trees.h"

namespace fasttree {
namespace {

using test::Rng;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A tree taken apart, to be broken.
struct Parts {
  TreeInfo info;
  std::vector<Node> nodes;
  std::vector<std::uint32_t> ids;

  explicit Parts(const Tree& tree)
      : info(tree.info()), nodes(test::nodes_of(tree)), ids(test::ids_of(tree)) {}
  Tree tree() const { return Tree(info, nodes, ids); }

  Node& leaf(std::size_t at_least_ids) {
    for (Node& n : nodes) {
      if (n.is_leaf() && n.count() >= at_least_ids) return n;
    }
    throw std::logic_error("the sample has no such leaf");
  }
};

Tree paper_sample() {
  Rng rng(5);
  return test::plain_paper_tree(test::random_mesh(rng, 40), AxisSchedule::cyclic, 9);
}

Tree box_sample() {
  Rng rng(6);
  return test::plain_box_tree(test::random_mesh(rng, 40), rng, 6);
}

// `inner` nodes one below the other, each with an empty leaf on the lower side.
Tree chain(std::uint32_t inner) {
  TreeInfo info;
  info.profile = Profile::sah_exact;
  info.triangle_count = 1;
  info.bounds = {{0, 0, 0}, {1, 1, 1}};
  std::vector<Node> nodes;
  for (std::uint32_t i = 0; i < inner; ++i) {
    nodes.push_back(Node::inner(0, 0.0f, 2 * i + 2));
    nodes.push_back(Node::leaf(0, 0));
  }
  nodes.push_back(Node::leaf(0, 1));
  return Tree(info, nodes, {0});
}

TEST(VerifyTree, GoodTreesPass) {
  const Verification empty = verify(Tree());
  EXPECT_TRUE(empty.ok) << empty.invariant << ": " << empty.detail;
  ASSERT_TRUE(rc::check([](std::uint64_t seed) {
    Rng rng(seed);
    const test::Mesh mesh = test::random_mesh(rng, *rc::gen::inRange<std::uint32_t>(0, 60));
    const int depth = *rc::gen::inRange(0, 13);
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      const Verification v = verify(test::plain_paper_tree(mesh, axes, depth));
      RC_ASSERT(v.ok);
      RC_ASSERT(v.checks > mesh.triangle_count());
    }
    RC_ASSERT(verify(test::plain_box_tree(mesh, rng, depth)).ok);
  }));
}

TEST(VerifyTree, DepthIsAllowedUpToItsLimit) {
  EXPECT_TRUE(verify(chain(kMaxTreeDepth)).ok);
  EXPECT_EQ(verify(chain(kMaxTreeDepth + 1)).invariant, "depth");
  EXPECT_EQ(verify(chain(1'000'000)).invariant, "depth");
}

struct Breakage {
  const char* invariant;
  const char* how;
  Tree (*sample)();
  std::function<void(Parts&)> damage;
};

// Every invariant of verify(tree), broken in turn by itself.
std::vector<Breakage> breakages() {
  using P = Parts&;
  return {
      {"profile", "unknown", paper_sample, [](P p) { p.info.profile = static_cast<Profile>(4); }},
      {"axis-schedule", "unknown", paper_sample,
       [](P p) { p.info.axes = static_cast<AxisSchedule>(2); }},
      {"triangle-count", "too many", box_sample, [](P p) { p.info.triangle_count = 1u << 30; }},
      {"node-count", "none", paper_sample, [](P p) { p.nodes.clear(); }},
      {"node-count", "even", paper_sample, [](P p) { p.nodes.push_back(Node::leaf(0, 0)); }},
      {"bounds", "not a number", box_sample, [](P p) { p.info.bounds.lo.y = kNan; }},
      {"bounds", "infinite", box_sample, [](P p) { p.info.bounds.hi.z = kInfinity; }},
      {"bounds", "extent overflows", box_sample,
       [](P p) {
         p.info.bounds.lo.x = -3e38f;
         p.info.bounds.hi.x = 3e38f;
       }},
      {"bounds", "upper before lower", box_sample,
       [](P p) { std::swap(p.info.bounds.lo.x, p.info.bounds.hi.x); }},
      {"bounds", "minus zero", box_sample, [](P p) { p.info.bounds.lo.x = -0.0f; }},
      {"bounds", "of an empty mesh", [] { return Tree(); }, [](P p) { p.info.bounds.hi.x = 1; }},
      {"grid", "depth over 30", paper_sample, [](P p) { p.info.depth = 255; }},
      {"grid", "bits moved", paper_sample,
       [](P p) {
         ++p.info.bits[0];
         --p.info.bits[1];
       }},
      {"grid", "schedule of another tree", paper_sample,
       [](P p) { p.info.axes = AxisSchedule::longest; }},
      {"grid", "none expected", box_sample, [](P p) { p.info.depth = 3; }},
      {"upper-child-range", "behind the end", paper_sample,
       [](P p) {
         p.nodes[0] = Node::inner(p.nodes[0].axis(), p.nodes[0].split(),
                                  static_cast<std::uint32_t>(p.nodes.size()));
       }},
      {"upper-child-range", "itself", paper_sample,
       [](P p) { p.nodes[0] = Node::inner(p.nodes[0].axis(), p.nodes[0].split(), 0); }},
      {"upper-child-range", "the lower child", paper_sample,
       [](P p) { p.nodes[0] = Node::inner(p.nodes[0].axis(), p.nodes[0].split(), 1); }},
      {"pre-order", "one too far", paper_sample,
       [](P p) {
         const Node n = p.nodes[0];
         p.nodes[0] = Node::inner(n.axis(), n.split(), n.upper() + 1);
       }},
      {"pre-order", "one too near", paper_sample,
       [](P p) {
         const Node n = p.nodes[0];
         p.nodes[0] = Node::inner(n.axis(), n.split(), n.upper() - 1);
       }},
      {"every-node-once", "nodes behind the tree", box_sample,
       [](P p) { p.nodes[0] = Node::leaf(0, 0); }},
      {"every-node-once", "one child of three parents", [] { return chain(2); },
       [](P p) {
         for (std::size_t i = 0; i < 3; ++i) p.nodes[i] = Node::inner(0, 0.5f, 4);
         p.nodes[3] = Node::leaf(0, 0);
       }},
      {"depth", "deeper than the grid",
       [] {
         test::Mesh mesh{
             {{0, 0, 0}, {0.4f, 0, 0}, {0.4f, 1, 0}, {0.6f, 0, 0}, {1, 0, 0}, {1, 1, 0}}};
         return test::plain_paper_tree(mesh, AxisSchedule::cyclic, 1);
       },
       [](P p) {
         const Node root = p.nodes[0];
         p.nodes = {Node::inner(root.axis(), root.split(), 2), Node::leaf(0, 1),
                    Node::inner(root.axis(), root.split(), 4), Node::leaf(1, 1), Node::leaf(2, 0)};
       }},
      {"split-finite", "not a number", box_sample,
       [](P p) { p.nodes[0].word1 = std::bit_cast<std::uint32_t>(kNan); }},
      {"split-finite", "infinite", box_sample,
       [](P p) { p.nodes[0].word1 = std::bit_cast<std::uint32_t>(-kInfinity); }},
      {"split-in-cell", "outside the bounds", box_sample,
       [](P p) { p.nodes[0] = Node::inner(0, 4.5f, p.nodes[0].upper()); }},
      {"split-in-cell", "outside the parent's half", [] { return chain(2); },
       [](P p) {
         p.nodes[0] = Node::inner(0, 0.5f, p.nodes[0].upper());
         p.nodes[2] = Node::inner(0, 0.25f, p.nodes[2].upper());
       }},
      {"split-on-plane", "the next number", paper_sample, [](P p) { --p.nodes[0].word1; }},
      {"split-on-plane", "a coarser axis", paper_sample,
       [](P p) { p.nodes[0] = Node::inner(2, 0.01f, p.nodes[0].upper()); }},
      {"leaf-range", "first", box_sample,
       [](P p) { p.leaf(1).word1 = static_cast<std::uint32_t>(p.ids.size()) + 1; }},
      {"leaf-range", "count", box_sample, [](P p) { p.leaf(1).word0 = 0xffffffffu; }},
      {"leaf-order", "overlap", box_sample, [](P p) { --p.nodes.back().word1; }},
      {"leaf-order", "gap", box_sample,
       [](P p) {
         Node& leaf = p.leaf(2);
         leaf = Node::leaf(leaf.first() + 1, leaf.count() - 1);
       }},
      {"leaf-order", "ids left over", paper_sample, [](P p) { p.ids.push_back(0); }},
      {"leaf-occupied", "empty leaf in a grid", paper_sample,
       [](P p) {
         p.nodes[1].is_leaf() ? p.nodes[1] = Node::leaf(0, 0) : p.leaf(1) = Node::leaf(0, 0);
       }},
      {"leaf-occupied", "triangles in an empty mesh", [] { return Tree(); },
       [](P p) {
         p.nodes[0] = Node::leaf(0, 1);
         p.ids = {0};
       }},
      {"triangle-id-range", "one too many", paper_sample,
       [](P p) { p.ids[0] = p.info.triangle_count; }},
      {"reference-order", "swapped", paper_sample,
       [](P p) {
         const Node leaf = p.leaf(2);
         std::swap(p.ids[leaf.first()], p.ids[leaf.first() + 1]);
       }},
      {"reference-order", "twice", box_sample,
       [](P p) {
         const Node leaf = p.leaf(2);
         p.ids[leaf.first() + 1] = p.ids[leaf.first()];
       }},
      {"triangle-coverage", "one in no leaf", box_sample, [](P p) { ++p.info.triangle_count; }},
      {"triangle-coverage", "more than there are references", box_sample,
       [](P p) { p.info.triangle_count = 1u << 29; }},
  };
}

TEST(VerifyTree, EachBreakageIsNamed) {
  std::set<std::string> broken;
  for (const Breakage& b : breakages()) {
    Parts parts(b.sample());
    ASSERT_TRUE(verify(parts.tree()).ok) << b.invariant;
    b.damage(parts);
    const Verification v = verify(parts.tree());
    EXPECT_FALSE(v.ok) << b.invariant << ", " << b.how;
    EXPECT_EQ(v.invariant, b.invariant) << b.how << ": " << v.detail;
    EXPECT_FALSE(v.detail.empty()) << b.invariant << ", " << b.how;
    broken.insert(b.invariant);
  }
  EXPECT_EQ(broken.size(), 19u) << "a new invariant needs its breakage here";
}

// Random words for random nodes: never a crash, a hang or a link followed unchecked (the sanitizers
// watch), and whatever passes has sound links.
TEST(VerifyTree, RandomNodesAreSafe) {
  Rng rng(17);
  int passed = 0;
  for (int round = 0; round < 20000; ++round) {
    Parts parts(round % 2 ? paper_sample() : box_sample());
    for (std::uint32_t changes = 1 + test::below(rng, 3); changes > 0; --changes) {
      Node& node = parts.nodes[test::below(rng, static_cast<std::uint32_t>(parts.nodes.size()))];
      switch (test::below(rng, 5)) {
        case 0:
          node.word0 = static_cast<std::uint32_t>(rng());
          break;
        case 1:
          node.word1 = static_cast<std::uint32_t>(rng());
          break;
        case 2:
          node.word0 ^= 1u << test::below(rng, 32);
          break;
        case 3:
          node.word1 ^= 1u << test::below(rng, 32);
          break;
        default:
          node.word0 = (node.word0 & 3) |
                       test::below(rng, static_cast<std::uint32_t>(parts.nodes.size()) + 2) << 2;
      }
    }
    const Tree tree = parts.tree();
    if (!verify(tree).ok) continue;
    ++passed;
    ASSERT_TRUE(device_image_from_tree(tree).ok());
  }
  EXPECT_GT(passed, 20) << "the judge saw some";
}

TEST(VerifyTree, RandomBytesAreSafe) {
  Rng rng(19);
  for (int round = 0; round < 20000; ++round) {
    TreeInfo info;
    info.profile = static_cast<Profile>(test::below(rng, 5));
    info.depth = static_cast<std::uint8_t>(test::below(rng, 4));
    info.bits[0] = info.depth;
    info.triangle_count = test::below(rng, 4);
    info.bounds.hi = {1, 0, 0};
    std::vector<Node> nodes(test::below(rng, 10));
    for (Node& n : nodes) {
      n = test::below(rng, 2) ? Node::leaf(test::below(rng, 4), test::below(rng, 3))
                              : Node::inner(0, 0.25f * static_cast<float>(test::below(rng, 5)),
                                            test::below(rng, 12));
    }
    std::vector<std::uint32_t> ids(test::below(rng, 6));
    for (std::uint32_t& id : ids) id = test::below(rng, 4);
    const Tree tree(info, nodes, ids);
    const Verification v = verify(tree);
    EXPECT_EQ(v.ok, v.invariant.empty());
    ASSERT_TRUE(!v.ok || device_image_from_tree(tree).ok());
  }
}

}  // namespace
}  // namespace fasttree
