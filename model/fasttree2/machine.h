// SPDX-License-Identifier: Apache-2.0
// Our accelerator: a build from the scene in memory to the tree in memory, cycle by cycle.
#pragma once

#include <optional>
#include <string>

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/vec.h"
#include "model/config/fasttree2_config.h"
#include "model/fasttree2/registers.h"
#include "model/memory/memory.h"
#include "model/report/simulation.h"

namespace fasttree::model {

struct MachineConfig;

/// Builds the mesh's tree with the machine and the memory of the configuration. The tree is that of
/// the library's profile `paper` with the same axes and depth. bad_input: the mesh;
/// invalid_argument: the configuration; cancelled; resource_limit: memory, options.max_cycles, or a
/// machine that is stuck, with who waits for whom.
Result<SimulationResult> simulate_fasttree2(const MeshView& mesh, const MachineConfig& config,
                                            const SimulationOptions& options);

namespace ft2 {

/// What tests may change beside the configuration.
struct Extras {
  Faults faults;
  /// What the host believes the bounds to be, where bounds are given; else the true ones.
  std::optional<Box3> given_bounds;
};

/// Figures of the machine beside those of every simulation.
struct Figures {
  std::uint64_t records = 0;  ///< of the first partition
  std::uint32_t record_bytes = 0;
  std::uint64_t partitions = 0;  ///< buckets partitioned once more
  std::uint64_t partitioned_records = 0;
  std::uint64_t most_chunks = 0;  ///< of memory's chunks in use or used before
  std::uint64_t plane_hits = 0;
  std::uint64_t plane_misses = 0;
  std::size_t most_stacked = 0;
  std::uint32_t generations = 0;  ///< 2 where given bounds were wrong
};

/// The same with any memory.
Result<SimulationResult> run(const MeshView& mesh, const std::string& name,
                             const FastTree2Config& config, double clock_mhz, Memory& memory,
                             const SimulationOptions& options, const Extras& extras = {},
                             Figures* figures = nullptr);

}  // namespace ft2
}  // namespace fasttree::model
