// SPDX-License-Identifier: Apache-2.0
// Step 6 of 6, path compression (PCU). Docs: docs/path_compression.md.
#pragma once

#include <cstdint>
#include <vector>

#include "fasttree/device_image.h"
#include "reference/bit_encoding.h"
#include "reference/internal_node.h"
#include "reference/leaf_node.h"

namespace fasttree::reference {

inline constexpr std::uint32_t kNoParent = 0xffffffffu;

/// The links of the compressed tree. Internal nodes go by rank; children as in DeviceInternalNode.
struct Links {
  std::vector<std::uint32_t> lower;  ///< of internal node j
  std::vector<std::uint32_t> upper;
  std::vector<std::uint32_t> internal_parent;  ///< kNoParent for the root
  std::vector<std::uint32_t> leaf_parent;      ///< kNoParent where the only leaf is the root
  std::uint32_t root = kDeviceLeaf;
  std::uint64_t climb_steps = 0;  ///< looks at the bitmap, over all nodes
};

/// One step up the complete tree.
struct Step {
  std::uint32_t parent = 0;
  bool upper_child = false;  ///< the node is its parent's upper child
};

/// The parent of a node that is not the root. Its lowest set bit i says how far it is up, and bit
/// i + 1 which child it is.
Step climb(std::uint32_t node_index);

/// Every leaf and internal node climbs to its nearest essential ancestor and writes itself there.
Links path_compression(const LeafTable& leaves, const InternalNodes& nodes,
                       const EssentialBitmap& bitmap, int depth);

}  // namespace fasttree::reference
