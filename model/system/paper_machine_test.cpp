// SPDX-License-Identifier: Apache-2.0
#include "model/system/paper_machine.h"

#include <gtest/gtest.h>

#include "model/system/compare_reference.h"
#include "model/system/pipe_memory.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

using test::PipeMemory;
using test::PipeSettings;

MachineConfig machine() {
  MachineConfig config;
  config.name = "test";
  config.clock_mhz = 163;
  return config;
}

Result<SimulationResult> simulate(const MeshView& mesh, const MachineConfig& config,
                                  const TestHooks& hooks = {}, const PipeSettings& pipe = {}) {
  PipeMemory memory(pipe);
  SimulationOptions options;
  options.keep_arrays = true;
  return simulate_paper(mesh, config, options, memory, hooks);
}

TEST(PaperMachine, MakesTheReferencesArraysOfEveryDegenerateMesh) {
  for (const auto& [name, owned] : fasttree::test::degenerate_meshes()) {
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      SCOPED_TRACE(name + std::string(", ") + to_string(axes));
      MachineConfig config = machine();
      config.paper.grid.axes = axes;
      const Result<SimulationResult> result = simulate(owned.view(), config);
      ASSERT_TRUE(result.ok()) << result.status().message();
      EXPECT_EQ(test::difference(owned.view(), config.paper, result.value()), "");
    }
  }
}

}  // namespace
}  // namespace fasttree::model
