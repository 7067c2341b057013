// SPDX-License-Identifier: Apache-2.0
#include "build/node_emission.h"

#include <tbb/parallel_for.h>

#include <array>
#include <bit>

namespace fasttree::build {
namespace {

// Emits the inner nodes above `count` subtrees in descending order, ending at node index `end`.
// code_of(j) is a Morton code in subtree j; place(j, end) puts the subtree before `end` and returns
// where it begins.
template <typename CodeOf, typename Place>
void emit_above(std::size_t count, std::uint32_t end, const Grid& grid, std::span<Node> nodes,
                const CodeOf& code_of, const Place& place) {
  // An internal node whose upper subtree is written and whose lower one is not.
  struct Open {
    int m;                     // highest different bit of the two leaves it lies between
    std::uint32_t upper_code;  // of the leaf above the split
    std::uint32_t upper;       // where its upper child lies
  };
  std::array<Open, kMaxDepth> open;
  std::size_t open_count = 0;
  std::uint32_t next = end;

  const auto close = [&] {
    const Open& node = open[--open_count];
    const Grid::Split split = grid.split_below(node.upper_code, node.m);
    nodes[--next] = Node::inner(split.axis, split.position, node.upper);
  };
  for (std::size_t j = count; j-- > 0;) {
    next = place(j, next);
    if (j == 0) break;
    // The node between subtrees j - 1 and j. Open nodes under it have both children now.
    const std::uint32_t code = code_of(j);
    const int m = std::bit_width(code_of(j - 1) ^ code) - 1;
    while (open_count > 0 && open[open_count - 1].m < m) close();
    open[open_count++] = {m, code, next};
  }
  while (open_count > 0) close();
}

}  // namespace

void emit_nodes(std::span<const LeafStart> leaves, std::uint32_t reference_end, const Grid& grid,
                std::uint32_t first_node, std::span<Node> nodes) {
  const auto end = static_cast<std::uint32_t>(first_node + 2 * leaves.size() - 1);
  emit_above(
      leaves.size(), end, grid, nodes, [&](std::size_t j) { return leaves[j].code; },
      [&](std::size_t j, std::uint32_t next) {
        nodes[--next] = Node::leaf(leaves[j].first, reference_end - leaves[j].first);
        reference_end = leaves[j].first;
        return next;
      });
}

void emit_tree(const BucketGrid& bucket_grid, const Buckets& buckets, const Grid& grid,
               Buffer<std::uint32_t>& first_node_of_bucket, Buffer<Node>& nodes) {
  // The buckets that hold something, and all their leaves.
  Buffer<std::uint32_t> used;
  std::size_t leaves = 0;
  for (std::uint32_t b = 0; b < bucket_grid.bucket_count(); ++b) {
    if (buckets.leaf_count[b] == 0) continue;
    used.push_back(b);
    leaves += buckets.leaf_count[b];
  }
  nodes.resize(2 * leaves - 1);
  first_node_of_bucket.resize(bucket_grid.bucket_count());
  emit_above(
      used.size(), static_cast<std::uint32_t>(nodes.size()), grid, nodes,
      [&](std::size_t j) { return used[j] << bucket_grid.cell_bits(); },
      [&](std::size_t j, std::uint32_t next) {
        next -= 2 * buckets.leaf_count[used[j]] - 1;
        first_node_of_bucket[used[j]] = next;
        return next;
      });
  tbb::parallel_for(std::size_t{0}, used.size(), [&](std::size_t j) {
    const std::uint32_t b = used[j];
    emit_nodes({buckets.leaves.data() + buckets.leaf_begin[b], buckets.leaf_count[b]},
               static_cast<std::uint32_t>(buckets.reference_begin[b + 1]), grid,
               first_node_of_bucket[b], nodes);
  });
}

}  // namespace fasttree::build
