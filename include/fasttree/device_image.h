// SPDX-License-Identifier: Apache-2.0
// The tree as the accelerator writes it to its memory, and the exact way there and back.
#pragma once

#include <cstdint>
#include <vector>

#include "fasttree/status.h"
#include "fasttree/tree.h"

namespace fasttree {

/// A child in the device image: bit 31 set, a leaf by its place in the leaf table; clear, an
/// internal node by its rank.
inline constexpr std::uint32_t kDeviceLeaf = 1u << 31;

/// A row of the leaf table (LNGU): a run of the sorted references.
struct DeviceLeaf {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  friend bool operator==(const DeviceLeaf&, const DeviceLeaf&) = default;
};

/// An internal node (INGU, PCU), stored at its in-order rank: node j lies between leaves j and j+1.
struct DeviceInternalNode {
  std::uint32_t lower = 0;  ///< child reference, see kDeviceLeaf
  std::uint32_t upper = 0;
  float split = 0.0f;
  std::uint32_t axis = 0;
  friend bool operator==(const DeviceInternalNode&, const DeviceInternalNode&) = default;
};

/// What the hardware leaves in memory: leaf table, internal nodes by rank, sorted triangle ids, and
/// where the root is. L leaves go with L - 1 internal nodes.
struct DeviceImage {
  TreeInfo info;
  std::uint32_t root = kDeviceLeaf;
  std::vector<DeviceLeaf> leaves;
  std::vector<DeviceInternalNode> internal;
  std::vector<std::uint32_t> ids;
  friend bool operator==(const DeviceImage&, const DeviceImage&) = default;
};

/// Device image to tree. bad_input, naming the node, where the image's links do not form one tree
/// with leaves and internal nodes in order.
Result<Tree> tree_from_device_image(const DeviceImage& image);

/// Tree to device image. bad_input where the tree's own links are broken.
Result<DeviceImage> device_image_from_tree(const Tree& tree);

}  // namespace fasttree
