// SPDX-License-Identifier: Apache-2.0
// A run of whichever machine a configuration describes.
#pragma once

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "model/config/machine_config.h"
#include "model/report/simulation.h"

namespace fasttree::model {

/// Builds the mesh's tree on the configuration's machine. Errors as simulate_paper() and
/// simulate_fasttree2().
Result<SimulationResult> simulate(const MeshView& mesh, const MachineConfig& config,
                                  const SimulationOptions& options = {});

}  // namespace fasttree::model
