// SPDX-License-Identifier: Apache-2.0
// Is every split the exact builder makes the cheapest there is? Judge: all planes of all boxes,
// counted box by box and costed from the definition, for every node of the tree.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "baseline/baseline.h"
#include "baseline/split_cost.h"
#include "baseline/test_meshes.h"
#include "baseline/triangle_clip.h"

namespace fasttree::baseline {
namespace {

using testing::build;
using testing::check_structure;
using testing::NodeCell;
using testing::Soup;
using testing::Which;

double surface(const Box3& box) {
  const double x = double{box.hi.x} - box.lo.x;
  const double y = double{box.hi.y} - box.lo.y;
  const double z = double{box.hi.z} - box.lo.z;
  return 2 * (x * y + y * z + z * x);
}

/// What one plane costs, from the definition.
double cost_of(const std::vector<Box3>& boxes, const Box3& cell, std::size_t axis, float split,
               const SahCosts& costs) {
  double lower = 0, planar = 0, upper = 0;
  for (const Box3& box : boxes) {
    const bool flat = box.lo[axis] == split && box.hi[axis] == split;
    planar += flat;
    lower += box.lo[axis] < split;
    upper += box.hi[axis] > split;
  }
  Box3 lower_cell = cell, upper_cell = cell;
  lower_cell.hi[axis] = split;
  upper_cell.lo[axis] = split;
  const double pl = surface(lower_cell) / surface(cell);
  const double pu = surface(upper_cell) / surface(cell);
  double best = std::numeric_limits<double>::infinity();
  for (const double below : {planar, 0.0}) {
    const double l = lower + below;
    const double u = upper + planar - below;
    const double c = costs.traversal + costs.intersection * (pl * l + pu * u);
    best = std::min(best, l == 0 || u == 0 ? 0.8 * c : c);
  }
  return best;
}

double cheapest_split(const std::vector<Box3>& boxes, const Box3& cell, const SahCosts& costs) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const Box3& box : boxes) {
      for (const float split : {box.lo[axis], box.hi[axis]}) {
        if (!(cell.lo[axis] < split && split < cell.hi[axis])) continue;
        best = std::min(best, cost_of(boxes, cell, axis, split, costs));
      }
    }
  }
  return best;
}

/// The triangles below each node, from its leaves up.
std::vector<std::set<std::uint32_t>> triangles_below(const Tree& tree) {
  const auto nodes = tree.nodes();
  std::vector<std::set<std::uint32_t>> below(nodes.size());
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const Node node = nodes[i];
    if (node.is_leaf()) {
      const auto* first = tree.ids().data() + node.first();
      below[i].insert(first, first + node.count());
    } else {
      below[i] = below[i + 1];
      below[i].insert(below[node.upper()].begin(), below[node.upper()].end());
    }
  }
  return below;
}

void check_all_splits(const Soup& soup, const SahCosts& costs) {
  const Result<Tree> result = build(soup, Which::exact, costs);
  ASSERT_TRUE(result.ok());
  const Tree& tree = result.value();
  const std::vector<NodeCell> cells = check_structure(tree, soup, Which::exact);
  const auto below = triangles_below(tree);
  for (std::size_t i = 0; i < tree.nodes().size(); ++i) {
    const Node node = tree.nodes()[i];
    if (cells[i].depth >= depth_bound(soup.size()) || below[i].empty()) {
      EXPECT_TRUE(node.is_leaf());
      continue;
    }
    std::vector<Box3> boxes;
    for (const std::uint32_t t : below[i]) {
      const ClippedPolygon part = clip_to_box(soup.view().triangle(t), cells[i].cell);
      ASSERT_GT(part.size, 0u) << "triangle " << t << " does not reach node " << i;
      boxes.push_back(outward_bounds(part, cells[i].cell));
    }
    const double best = cheapest_split(boxes, cells[i].cell, costs);
    const double as_leaf = costs.intersection * static_cast<double>(boxes.size());
    if (node.is_leaf()) {
      EXPECT_GE(best, as_leaf * (1 - 1e-9)) << "leaf " << i << " should have been split";
    } else {
      const double chosen = cost_of(boxes, cells[i].cell, node.axis(), node.split(), costs);
      EXPECT_NEAR(chosen, best, 1e-9 * best) << "node " << i;
      EXPECT_LT(chosen, as_leaf * (1 + 1e-9)) << "node " << i << " should have been a leaf";
    }
  }
}

TEST(ExactSplit, IsTheCheapestForRandomTriangles) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    check_all_splits(testing::random_soup(1 + seed, seed % 2 == 0 ? 0.1f : 0.6f, seed), {});
  }
}

TEST(ExactSplit, FollowsTheCosts) {
  const Soup soup = testing::random_soup(80, 0.15f, 7);
  check_all_splits(soup, {1.0, 1.0});
  check_all_splits(soup, {1.0, 4.0});
  check_all_splits(soup, {100.0, 1.0});
}

/// The same tree in quadratic time: no events, no sorting, no merging. Each node keeps the boxes of
/// its triangles and tries both ends of every one, counting afresh for each plane.
class PlainBuilder {
 public:
  PlainBuilder(const Soup& soup, const SahCosts& costs) : soup_(soup), costs_(costs) {
    std::vector<Part> parts;
    for (std::uint32_t t = 0; t < soup.size(); ++t) {
      Part part{t, {}};
      for (const Vec3& p : soup.view().triangle(t)) part.box.include(p);
      parts.push_back(part);
    }
    node(parts, soup.bounds(), 0);
  }

  std::vector<Node> nodes;
  std::vector<std::uint32_t> ids;

 private:
  struct Part {
    std::uint32_t triangle = 0;
    Box3 box;
  };

  static bool flat_at(const Box3& box, const Split& split) {
    return box.lo[split.axis] == split.position && box.hi[split.axis] == split.position;
  }
  static bool in_lower(const Box3& box, const Split& split) {
    return box.lo[split.axis] < split.position || (split.planar_to_lower && flat_at(box, split));
  }
  static bool in_upper(const Box3& box, const Split& split) {
    return box.hi[split.axis] > split.position || (!split.planar_to_lower && flat_at(box, split));
  }

  std::optional<Split> best_split(const std::vector<Part>& parts, const Box3& cell) const {
    std::optional<Split> best;
    double best_cost = leaf_cost(parts.size(), costs_);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      std::set<float> positions;
      for (const Part& part : parts) {
        // Adding zero turns -0 into +0.
        positions.insert({part.box.lo[axis] + 0.0f, part.box.hi[axis] + 0.0f});
      }
      for (const float position : positions) {
        if (!(cell.lo[axis] < position && position < cell.hi[axis])) continue;
        for (const bool planar_to_lower : {false, true}) {
          Split split{axis, position, planar_to_lower, 0, 0, 0};
          for (const Part& part : parts) {
            split.lower_count += in_lower(part.box, split);
            split.upper_count += in_upper(part.box, split);
          }
          const double cost =
              SplitCost(cell, axis, costs_)(position, split.lower_count, split.upper_count);
          if (cost < best_cost) {
            best_cost = cost;
            best = split;
          }
        }
      }
    }
    return best;
  }

  void node(const std::vector<Part>& parts, const Box3& cell, std::uint32_t depth) {
    std::optional<Split> split;
    if (!parts.empty() && depth < depth_bound(soup_.size())) split = best_split(parts, cell);
    if (!split) {
      nodes.push_back(Node::leaf(static_cast<std::uint32_t>(ids.size()),
                                 static_cast<std::uint32_t>(parts.size())));
      for (const Part& part : parts) ids.push_back(part.triangle);
      return;
    }
    std::vector<Part> lower, upper;
    for (const Part& part : parts) {
      const bool below = in_lower(part.box, *split);
      const bool above = in_upper(part.box, *split);
      if (below && above) {
        const CutBounds cut =
            cut_bounds(soup_.view().triangle(part.triangle), cell, split->axis, split->position);
        if (cut.in_lower) lower.push_back({part.triangle, cut.lower});
        if (cut.in_upper) upper.push_back({part.triangle, cut.upper});
      } else {
        (below ? lower : upper).push_back(part);
      }
    }
    Box3 lower_cell = cell, upper_cell = cell;
    lower_cell.hi[split->axis] = split->position;
    upper_cell.lo[split->axis] = split->position;
    const std::size_t index = nodes.size();
    nodes.push_back({});
    node(lower, lower_cell, depth + 1);
    nodes[index] =
        Node::inner(split->axis, split->position, static_cast<std::uint32_t>(nodes.size()));
    node(upper, upper_cell, depth + 1);
  }

  const Soup& soup_;
  SahCosts costs_;
};

void check_against_plain_builder(const Soup& soup, const SahCosts& costs) {
  const Result<Tree> result = build(soup, Which::exact, costs);
  ASSERT_TRUE(result.ok());
  const PlainBuilder plain(soup, costs);
  const auto nodes = result.value().nodes();
  const auto ids = result.value().ids();
  EXPECT_TRUE(std::equal(nodes.begin(), nodes.end(), plain.nodes.begin(), plain.nodes.end()));
  EXPECT_TRUE(std::equal(ids.begin(), ids.end(), plain.ids.begin(), plain.ids.end()));
}

TEST(ExactSplit, MakesTheTreeOfThePlainBuilder) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    check_against_plain_builder(testing::random_soup(1 + 3 * seed, 0.2f, seed), {});
    check_against_plain_builder(testing::lattice_soup(1 + 3 * seed, 4, seed), {});
    check_against_plain_builder(testing::lattice_soup(1 + seed, 2, seed), {1, 10});
  }
  check_against_plain_builder(testing::bumpy_ball(10), {});
}

TEST(ExactSplit, CutsOffEmptySpace) {
  // Two triangles far apart on x: the cheapest plane is an end of one of them, and then the empty
  // middle goes as well.
  Soup soup;
  soup.add({0, 0, 0}, {1, 1, 0}, {0, 1, 1});
  soup.add({99, 0, 0}, {100, 1, 0}, {99, 1, 1});
  const Result<Tree> tree = build(soup, Which::exact);
  ASSERT_TRUE(tree.ok());
  const Node root = tree.value().nodes()[0];
  ASSERT_FALSE(root.is_leaf());
  EXPECT_EQ(root.axis(), 0u);
  EXPECT_TRUE(root.split() == 1.0f || root.split() == 99.0f);
  const Quality quality = measure_quality(tree.value());
  EXPECT_GE(quality.empty_leaves, 1u);
}

TEST(SplitCost, AgreesWithTheDefinition) {
  const Box3 cell{{1, 2, 3}, {4, 8, 5}};
  const SahCosts costs{3, 7};
  // Surfaces: whole 2 (18 + 12 + 6) = 72; lower at y = 4: 2 (6 + 4 + 6) = 32; upper 2 (12 + 8 + 6)
  // = 52.
  EXPECT_DOUBLE_EQ(SplitCost(cell, 1, costs)(4.0, 5, 2), 3 + 7 * (32.0 * 5 + 52.0 * 2) / 72);
  EXPECT_DOUBLE_EQ(SplitCost(cell, 1, costs)(4.0, 0, 2), 0.8 * (3 + 7 * 52.0 * 2 / 72));
  EXPECT_DOUBLE_EQ(leaf_cost(6, costs), 42.0);
}

}  // namespace
}  // namespace fasttree::baseline
