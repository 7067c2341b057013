// SPDX-License-Identifier: Apache-2.0
// The accelerator of the paper: its units round the bus, and the global control that takes a scene
// in memory through the six steps to the finished device image.
#pragma once

#include <cstdint>
#include <string>

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "model/config/machine_config.h"
#include "model/memory/memory.h"
#include "model/report/simulation.h"

namespace fasttree::model {

/// What tests break, and the order in which units are ticked, which must not matter.
struct TestHooks {
  std::uint64_t drop_beat = 0;   ///< the n-th beat on the bus is lost; 0: none
  bool wrong_victim = false;     ///< the cache evicts the block used last
  std::string dead_unit;         ///< a unit that gets no clock
  std::uint32_t tick_order = 0;  ///< seed of another order; 0: as built
};

/// Whether the values of a configuration fit together (each alone is in its range already).
Status validate(const PaperConfig& config);

/// Runs the machine on a scene. Errors: the scene's and the depth rule's as Builder::build;
/// resource_limit where the memory or options.max_cycles does not suffice, or where the machine is
/// stuck, with who waits for whom; cancelled.
Result<SimulationResult> simulate_paper(const MeshView& mesh, const MachineConfig& config,
                                        const SimulationOptions& options);

/// The same with a memory of the caller's, which has to be idle.
Result<SimulationResult> simulate_paper(const MeshView& mesh, const MachineConfig& config,
                                        const SimulationOptions& options, Memory& memory,
                                        const TestHooks& hooks = {});

}  // namespace fasttree::model
