// SPDX-License-Identifier: Apache-2.0
#include "device/engines/engine.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "device/link/messages.h"
#include "model/memory/make_memory.h"
#include "model/report/simulate.h"
#include "rtl/engine/rtl_machine.h"

namespace fasttree::device {
namespace {

Outcome outcome_of(model::SimulationResult&& result) {
  Outcome outcome;
  outcome.tree = std::move(result.tree);
  outcome.counters.cycles = result.cycles;
  outcome.counters.clock_mhz = result.clock_mhz;
  outcome.counters.build_ms = result.time_ms();
  for (const model::StageRecord& stage : result.stages) {
    outcome.counters.stages.push_back({stage.name, stage.begin_cycle, stage.end_cycle, 0});
  }
  return outcome;
}

constexpr std::uint64_t kMostSceneBytes = std::uint64_t{kTriangleBytes} * kMaxTriangles;

// What the machine's memory holds, at most: arrays of its own come beside the scene.
std::uint64_t most_scene_bytes(const model::MachineConfig& config) {
  const std::uint64_t capacity = model::make_memory(config.memory)->traits().capacity_bytes;
  return capacity == 0 ? kMostSceneBytes : std::min(capacity, kMostSceneBytes);
}

template <typename Simulate>
Engine machine_engine(const char* name, const model::MachineConfig& config, Simulate simulate) {
  Engine engine{name, config.name, most_scene_bytes(config), {}};
  engine.build = [config, simulate](const MeshView& mesh, const Order&,
                                    const ProgressCallback& progress) -> Result<Outcome> {
    model::SimulationOptions options;
    options.timeline_windows = 0;
    options.progress = progress;
    Result<model::SimulationResult> result = simulate(mesh, config, options);
    if (!result.ok()) return result.status();
    return outcome_of(std::move(result).value());
  };
  return engine;
}

}  // namespace

Engine library_engine() {
  Engine engine{"library", "", kMostSceneBytes, {}};
  engine.build = [builder = std::make_shared<Builder>()](
                     const MeshView& mesh, const Order& order,
                     const ProgressCallback& progress) -> Result<Outcome> {
    BuildSettings settings = settings_of(order);
    settings.progress = progress;
    Result<Tree> tree = builder->build(mesh, settings);
    if (!tree.ok()) return tree.status();
    Outcome outcome;
    outcome.tree = std::move(tree).value();
    outcome.counters.build_ms = builder->stats().build_ms;
    for (const StageTime& stage : builder->stats().stages) {
      outcome.counters.stages.push_back({stage.stage, 0, 0, stage.ms});
    }
    return outcome;
  };
  return engine;
}

Engine model_engine(const model::MachineConfig& config) {
  return machine_engine("model", config,
                        [](const MeshView& mesh, const model::MachineConfig& machine,
                           const model::SimulationOptions& options) {
                          return model::simulate(mesh, machine, options);
                        });
}

Result<Engine> rtl_engine(const model::MachineConfig& config) {
  if (Status status = rtl::check_built(config); !status.ok()) return status;
  return machine_engine("rtl", config,
                        [](const MeshView& mesh, const model::MachineConfig& machine,
                           const model::SimulationOptions& options) {
                          return rtl::simulate_rtl(mesh, machine, options);
                        });
}

Result<Engine> make_engine(const std::string& name, const std::string& config) {
  if (name == "library") {
    if (config.empty()) return library_engine();
    return Status(
        StatusCode::invalid_argument,
        "engine library has no configuration; give engine model or rtl with '" + config + "'");
  }
  if (name != "model" && name != "rtl") {
    return Status(StatusCode::invalid_argument,
                  "there is no engine '" + name + "'; give library, model or rtl");
  }
  const Result<model::MachineConfig> machine =
      model::load_config(config.empty() ? "paper-asic65" : config);
  if (!machine.ok()) return machine.status();
  if (name == "model") return model_engine(machine.value());
  return rtl_engine(machine.value());
}

}  // namespace fasttree::device
