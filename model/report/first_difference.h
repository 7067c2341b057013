// SPDX-License-Identifier: Apache-2.0
// A run against the reference builder: every array that the machine keeps between its steps, and
// the tree.
#pragma once

#include <string>

#include "fasttree/build.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "model/config/machine_config.h"
#include "model/report/simulation.h"

namespace fasttree::model {

/// How the library builds the tree that this machine has to build.
BuildSettings build_settings(const MachineConfig& config);

/// Which array differs from the reference's first, in the order of the steps, and at which index;
/// empty where nothing does. The run has to have kept its arrays. Errors as Builder::build.
Result<std::string> first_difference(const MeshView& mesh, const MachineConfig& config,
                                     const SimulationResult& result,
                                     const ProgressCallback& progress = {});

}  // namespace fasttree::model
