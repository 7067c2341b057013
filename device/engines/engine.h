// SPDX-License-Identifier: Apache-2.0
// Who builds in this process: the library, the cycle-level model of a machine, or its RTL.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "device/order.h"
#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "model/config/machine_config.h"

namespace fasttree::device {

struct Engine {
  std::string name;
  std::string config;                  ///< of a machine
  std::uint64_t most_scene_bytes = 0;  ///< more do not fit it
  /// Builds on the calling thread, and on those of its task arena.
  std::function<Result<Outcome>(const MeshView&, const Order&, const ProgressCallback&)> build;
};

/// Follows the order. Keeps its working memory from build to build.
Engine library_engine();

// Machines follow their configuration alone: grid, depth, and the memory that it has.
Engine model_engine(const model::MachineConfig& config);
/// invalid_argument where no RTL was built for the configuration, or none at all.
Result<Engine> rtl_engine(const model::MachineConfig& config);

/// "library", "model" or "rtl", with a configuration's name or file for the latter two. bad_input,
/// io_error: the configuration; invalid_argument: another name, a configuration for the library, or
/// as rtl_engine().
Result<Engine> make_engine(const std::string& name, const std::string& config);

}  // namespace fasttree::device
