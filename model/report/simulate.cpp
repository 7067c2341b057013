// SPDX-License-Identifier: Apache-2.0
#include "model/report/simulate.h"

#include <memory>
#include <string>

#include "model/fasttree2/machine.h"
#include "model/memory/make_memory.h"
#include "model/system/paper_machine.h"

namespace fasttree::model {

Result<SimulationResult> simulate(const MeshView& mesh, const MachineConfig& config,
                                  const SimulationOptions& options) {
  // Every way to change a configuration validates its memory; a caller may have set members.
  if (Status status = validate(config.memory); !status.ok()) return status;
  const std::unique_ptr<Memory> memory = make_memory(config.memory);
  Result<SimulationResult> result =
      config.architecture == "fasttree-2"
          ? ft2::run(mesh, config.name, config.fasttree2, config.clock_mhz, *memory, options)
          : simulate_paper(mesh, config, options, *memory);
  // The machines look at the limit every few thousand cycles: a short run ends before.
  if (result.ok() && options.max_cycles != 0 && result.value().cycles > options.max_cycles) {
    return Status(StatusCode::resource_limit,
                  "the run took " + std::to_string(result.value().cycles) + " cycles, more than " +
                      std::to_string(options.max_cycles) + ", its limit. Raise the limit.");
  }
  return result;
}

}  // namespace fasttree::model
