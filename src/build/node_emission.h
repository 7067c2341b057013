// SPDX-License-Identifier: Apache-2.0
// Steps 5 and 6, fast: the pre-order nodes straight from the leaf codes.
#pragma once

#include <cstdint>
#include <span>

#include "fasttree/tree.h"
#include "grid/grid.h"

namespace fasttree::build {

/// Writes the 2 L - 1 nodes of the tree over L >= 1 leaves. `leaf_codes` ascend; `leaf_first` are
/// their base indices, the end of the last leaf being `reference_count`.
///
/// Going over the leaves from the last to the first and filling `nodes` from its end needs no
/// links, no bitmap and no second pass: when a node's lower subtree is complete, the node itself is
/// next in reversed pre-order. At most `depth` ancestors are open at any time.
void emit_nodes(std::span<const std::uint32_t> leaf_codes,
                std::span<const std::uint32_t> leaf_first, std::uint32_t reference_count,
                const Grid& grid, std::span<Node> nodes);

}  // namespace fasttree::build
