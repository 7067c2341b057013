// SPDX-License-Identifier: Apache-2.0
// What each stage leaves in memory, as words by name: for finding where two machines part.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "model/config/machine_config.h"
#include "model/report/simulation.h"

namespace fasttree::model {

struct StageArray {
  std::string stage;  ///< stem: "scene_bound", "morton_code", ...
  std::string name;   ///< "sorted_codes"
  std::vector<std::uint32_t> words;
};

/// Of a run with SimulationOptions::keep_arrays, in the order of the stages.
std::vector<StageArray> stage_arrays(const SimulationResult& result);

/// The reference builder's, in the same order. Errors as Builder::build.
Result<std::vector<StageArray>> reference_stage_arrays(const MeshView& mesh,
                                                       const MachineConfig& config,
                                                       const ProgressCallback& progress);

}  // namespace fasttree::model
