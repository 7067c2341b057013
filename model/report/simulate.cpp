// SPDX-License-Identifier: Apache-2.0
#include "model/report/simulate.h"

#include <string>

#include "model/fasttree2/machine.h"
#include "model/system/paper_machine.h"

namespace fasttree::model {

Result<SimulationResult> simulate(const MeshView& mesh, const MachineConfig& config,
                                  const SimulationOptions& options) {
  Result<SimulationResult> result = config.architecture == "fasttree-2"
                                        ? simulate_fasttree2(mesh, config, options)
                                        : simulate_paper(mesh, config, options);
  // The machines look at the limit every few thousand cycles: a short run ends before.
  if (result.ok() && options.max_cycles != 0 && result.value().cycles > options.max_cycles) {
    return Status(StatusCode::resource_limit,
                  "the run took " + std::to_string(result.value().cycles) + " cycles, more than " +
                      std::to_string(options.max_cycles) + ", its limit. Raise the limit.");
  }
  return result;
}

}  // namespace fasttree::model
