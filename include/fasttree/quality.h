// SPDX-License-Identifier: Apache-2.0
// How good is this tree? Counts, and what the surface-area heuristic expects a ray to cost.
#pragma once

#include <cstdint>
#include <vector>

#include "fasttree/tree.h"

namespace fasttree {

/// Figures of a tree. Expected values are for a random line that hits the scene's bounds: the sum
/// over nodes of the node's area over the root's (MacDonald and Booth 1990).
struct Quality {
  std::uint64_t nodes = 0;
  std::uint64_t inner_nodes = 0;
  std::uint64_t leaves = 0;
  std::uint64_t empty_leaves = 0;
  std::uint64_t references = 0;
  double references_per_triangle = 0;
  std::uint32_t max_depth = 0;  ///< inner nodes above the deepest leaf
  double mean_leaf_depth = 0;
  std::uint32_t max_leaf_size = 0;
  double mean_leaf_size = 0;  ///< over leaves that are not empty
  std::vector<std::uint64_t>
      leaf_size_histogram;  ///< [0]: empty, [1]: 1, [2]: 2, [i]: up to 2^(i-1)
  double expected_inner_steps = 0;
  double expected_leaf_visits = 0;
  double expected_triangle_tests = 0;
  double sah_cost = 0;  ///< traversal_cost * steps + intersection_cost * tests
};

/// Costs of the surface-area heuristic, in arbitrary units. Defaults: Wald and Havran 2006.
struct SahCosts {
  double traversal = 15.0;
  double intersection = 20.0;
};

/// One pass over a tree that passes verify().
Quality measure_quality(const Tree& tree, const SahCosts& costs = {});

}  // namespace fasttree
