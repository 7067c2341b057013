// SPDX-License-Identifier: Apache-2.0
#include "device/engines/engine.h"

#include <memory>
#include <utility>

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

template <typename Simulate>
Engine machine_engine(const char* name, const model::MachineConfig& config, Simulate simulate) {
  Engine engine{name, config.name, {}};
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
  Engine engine{"library", "", {}};
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

Engine rtl_engine(const model::MachineConfig& config) {
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
  return name == "model" ? model_engine(machine.value()) : rtl_engine(machine.value());
}

}  // namespace fasttree::device
