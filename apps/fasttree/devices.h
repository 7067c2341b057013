// SPDX-License-Identifier: Apache-2.0
// Trees from a device: the option --device, and what the device counted.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "command.h"
#include "device/link/counts.h"
#include "device/order.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "options.h"
#include "output.h"

namespace fasttree::app {

/// A tree that a device has built, and what is known of how.
struct DeviceTree {
  device::Description device;
  Tree tree;
  device::Counters counters;
  double total_ms = 0;                     ///< from the order to the tree, the network included
  std::optional<device::LinkCounts> link;  ///< of a remote one
};

/// Shared by the subcommands that can take their tree from a device.
class DeviceOptions {
 public:
  void declare(Options& options);
  bool given() const { return !device_.empty(); }
  /// Which device, as it was named.
  const std::string& name() const { return device_; }

  /// Builds there. Throws Failure, and does not look at the tree's links.
  DeviceTree build(Context& context, const MeshView& mesh, const BuildSettings& settings) const;

 private:
  std::string device_;
  std::uint32_t payload_ = 1440;
  double timeout_s_ = 5;
  double wait_s_ = 0;
};

/// Throws where the tree breaks an invariant, without or with its mesh: whatever uses a tree relies
/// on them, and a device may send anything.
void check_tree_of(const DeviceTree& built, const MeshView& mesh);

nlohmann::ordered_json json_of(const DeviceTree& built);
nlohmann::ordered_json json_of(const device::LinkCounts& counts);
void print_device(Output& output, const DeviceTree& built);

}  // namespace fasttree::app
