// SPDX-License-Identifier: Apache-2.0
#include "model/report/simulate.h"

#include "model/fasttree2/machine.h"
#include "model/system/paper_machine.h"

namespace fasttree::model {

Result<SimulationResult> simulate(const MeshView& mesh, const MachineConfig& config,
                                  const SimulationOptions& options) {
  if (config.architecture == "fasttree-2") return simulate_fasttree2(mesh, config, options);
  return simulate_paper(mesh, config, options);
}

}  // namespace fasttree::model
