// SPDX-License-Identifier: Apache-2.0
// The machine as a configuration describes it, with that configuration's memory.
#include <memory>

#include "model/config/machine_config.h"
#include "model/fasttree2/machine.h"
#include "model/memory/make_memory.h"

namespace fasttree::model {

Result<SimulationResult> simulate_fasttree2(const MeshView& mesh, const MachineConfig& config,
                                            const SimulationOptions& options) {
  if (Status status = validate(config.memory); !status.ok()) return status;
  const std::unique_ptr<Memory> memory = make_memory(config.memory);
  return ft2::run(mesh, config.name, config.fasttree2, config.clock_mhz, *memory, options);
}

}  // namespace fasttree::model
