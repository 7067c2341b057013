// SPDX-License-Identifier: Apache-2.0
// Quality figures: one walk over the nodes with the box of each.
#include "fasttree/quality.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

namespace fasttree {
namespace {

/// A cell in double, so that neither an extent nor an area of finite binary32 bounds overflows.
struct Cell {
  std::array<double, 3> lo{};
  std::array<double, 3> hi{};

  double extent(std::size_t axis) const { return std::max(hi[axis] - lo[axis], 0.0); }
};

/// Turns a cell into the probability that a random line through the root's cell meets it.
///
/// By the ratio of the areas where the root has an area. A root that is a segment or a point has
/// none: there the ratio of the lengths stands in, and for a point every node counts as met.
class HitProbability {
 public:
  explicit HitProbability(const Cell& root) {
    const double area = half_area(root);
    const double length = total_length(root);
    if (area > 0) {
      measure_ = &half_area;
      root_measure_ = area;
    } else if (length > 0) {
      measure_ = &total_length;
      root_measure_ = length;
    }
  }

  double operator()(const Cell& cell) const {
    return measure_ != nullptr ? measure_(cell) / root_measure_ : 1.0;
  }

 private:
  static double half_area(const Cell& cell) {
    const double x = cell.extent(0), y = cell.extent(1), z = cell.extent(2);
    return x * y + y * z + z * x;
  }
  static double total_length(const Cell& cell) {
    return cell.extent(0) + cell.extent(1) + cell.extent(2);
  }

  double (*measure_)(const Cell&) = nullptr;
  double root_measure_ = 1.0;
};

/// Place in the histogram: 0 for empty, else 1 + ceil(log2 count).
std::size_t histogram_bucket(std::uint32_t count) {
  return count == 0 ? 0 : static_cast<std::size_t>(std::bit_width(count - 1)) + 1;
}

/// A subtree that the walk has still to enter.
struct Pending {
  Cell cell;
  std::uint32_t node = 0;
  std::uint32_t depth = 0;
};

}  // namespace

Quality measure_quality(const Tree& tree, const SahCosts& costs) {
  Quality quality;
  const auto nodes = tree.nodes();
  quality.nodes = nodes.size();
  if (nodes.empty()) return quality;

  Cell root;
  for (std::size_t a = 0; a < 3; ++a) {
    root.lo[a] = tree.info().bounds.lo[a];
    root.hi[a] = tree.info().bounds.hi[a];
  }
  const HitProbability hit_probability(root);

  std::uint64_t leaf_depths = 0;
  std::vector<Pending> stack{{root, 0, 0}};
  while (!stack.empty()) {
    const Pending at = stack.back();
    stack.pop_back();
    const Node node = nodes[at.node];
    const double probability = hit_probability(at.cell);

    if (node.is_leaf()) {
      const std::uint32_t count = node.count();
      ++quality.leaves;
      quality.empty_leaves += count == 0;
      quality.references += count;
      quality.max_depth = std::max(quality.max_depth, at.depth);
      quality.max_leaf_size = std::max(quality.max_leaf_size, count);
      leaf_depths += at.depth;
      const std::size_t bucket = histogram_bucket(count);
      if (quality.leaf_size_histogram.size() <= bucket) {
        quality.leaf_size_histogram.resize(bucket + 1);
      }
      ++quality.leaf_size_histogram[bucket];
      quality.expected_leaf_visits += probability;
      quality.expected_triangle_tests += probability * count;
      continue;
    }

    ++quality.inner_nodes;
    quality.expected_inner_steps += probability;
    const std::size_t axis = node.axis();
    const double split = node.split();
    Pending lower{at.cell, at.node + 1, at.depth + 1};
    Pending upper{at.cell, node.upper(), at.depth + 1};
    lower.cell.hi[axis] = split;
    upper.cell.lo[axis] = split;
    stack.push_back(upper);
    stack.push_back(lower);
  }

  const auto ratio = [](std::uint64_t a, std::uint64_t b) {
    return b == 0 ? 0.0 : static_cast<double>(a) / static_cast<double>(b);
  };
  quality.references_per_triangle = ratio(quality.references, tree.info().triangle_count);
  quality.mean_leaf_depth = ratio(leaf_depths, quality.leaves);
  quality.mean_leaf_size = ratio(quality.references, quality.leaves - quality.empty_leaves);
  quality.sah_cost = costs.traversal * quality.expected_inner_steps +
                     costs.intersection * quality.expected_triangle_tests;
  return quality;
}

}  // namespace fasttree
