// SPDX-License-Identifier: Apache-2.0
// Steps 5 and 6, fast: the pre-order nodes straight from the sorted leaves.
//
// Going over the leaves from the last to the first and filling the nodes from their end needs no
// links, no bitmap and no second pass: when a node's lower subtree is complete, the node itself is
// next in reversed pre-order. At most `depth` ancestors are open at any time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "build/buckets.h"
#include "build/buffer.h"
#include "fasttree/tree.h"
#include "grid/grid.h"

namespace fasttree::build {

/// Writes the 2 L - 1 nodes over L >= 1 leaves with ascending codes to nodes[first_node ...]. The
/// last leaf's references end at `reference_end`.
void emit_nodes(std::span<const LeafStart> leaves, std::uint32_t reference_end, const Grid& grid,
                std::uint32_t first_node, std::span<Node> nodes);

/// The whole tree: each bucket's subtree is one run of nodes, so the nodes above them are written
/// first, which says where each run begins, and then all runs in parallel. `nodes` is resized.
void emit_tree(const BucketGrid& bucket_grid, const Buckets& buckets, const Grid& grid,
               Buffer<std::uint32_t>& first_node_of_bucket, Buffer<Node>& nodes);

}  // namespace fasttree::build
