// SPDX-License-Identifier: Apache-2.0
// fasttree diff: where do the reference builder, the model and the RTL first differ, word by word?
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "inputs.h"
#include "model/config/machine_config.h"
#include "model/report/array_comparison.h"
#include "model/report/simulate.h"
#include "model/report/stage_arrays.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "rtl/engine/rtl_machine.h"

namespace fasttree::app {
namespace {

using model::ArrayComparison;
using model::Party;
using nlohmann::ordered_json;

class DiffCommand : public Command {
 public:
  const char* name() const override { return "diff"; }
  const char* summary() const override {
    return "Find the first word in which reference, model and RTL differ";
  }
  const char* details() const override {
    return "Builds the scene with the reference builder, on the cycle-level model and on the RTL,\n"
           "and compares what each stage left in memory, in the order of the stages: the first\n"
           "word that differs is where to look for the fault. Exit 1 where one is found. The "
           "cycles\n"
           "that model and RTL took stand below.\n\n"
           "Example:\n"
           "  fasttree diff bunny.ply\n"
           "  fasttree diff scene:knot?triangles=2000 --stage radix_sort --config paper-asic65";
  }

  void declare(Options& options) override {
    options.positional(scene_, "SCENE", "A mesh file, or scene:NAME");
    options.text(config_, "--config", "NAME|FILE", "The machine: a paper-* configuration");
    options.texts(set_, "--set", "SECTION.KEY=VALUE", "Change a key; may be given again");
    options.choice(stage_, "--stage", "Compare this stage alone", stages());
    options.choice(rtl_, "--engine", "What is compared with the reference",
                   Choices<int>{{"both", kBoth}, {"model", kModel}, {"rtl", kRtl}});
  }

  int run(Context& context) override {
    model::MachineConfig config = take(model::load_config(config_));
    for (const std::string& assignment : set_) check(apply_override(config, assignment));
    if (config.architecture != "paper") {
      throw Failure{kUsage, "diff is for the paper's architecture (paper-*); " +
                                config.architecture +
                                " leaves other arrays behind. Compare its "
                                "tree by fasttree simulate --verify."};
    }
    const LoadedScene scene = load_scene(context, scene_, most_of_memory());

    std::vector<Party> parties;
    parties.push_back(
        {"reference", take(reference_stage_arrays(scene.view, config,
                                                  context.progress.callback("reference:")))});
    std::vector<Cycles> cycles;
    for (const bool rtl : {false, true}) {
      if (rtl_ == (rtl ? kModel : kRtl)) continue;
      const model::SimulationResult result = simulated(context, scene.view, config, rtl);
      const char* name = rtl ? "rtl" : "model";
      parties.push_back({name, stage_arrays(result)});
      cycles.push_back({name, result.cycles, result.stages});
    }
    context.progress.clear();
    return compare(context, scene.mesh.name, config, parties, cycles);
  }

 private:
  enum { kBoth, kModel, kRtl };

  static Choices<std::string> stages() {
    Choices<std::string> list{{"all", ""}};
    for (const char* stage : {"scene_bound", "morton_code", "radix_sort", "leaf_node",
                              "internal_node", "bit_encoding", "path_compression"}) {
      list.emplace_back(stage, stage);
    }
    return list;
  }

  /// What a machine took, in all and by stage.
  struct Cycles {
    std::string name;
    std::uint64_t all = 0;
    std::vector<model::StageRecord> stages;
  };

  static model::SimulationResult simulated(Context& context, const MeshView& mesh,
                                           const model::MachineConfig& config, bool rtl) {
    model::SimulationOptions options;
    options.keep_arrays = true;
    options.keep_broken = true;
    options.timeline_windows = 0;
    options.progress = context.progress.callback(rtl ? "RTL:" : "model:");
    model::SimulationResult result = take(rtl ? rtl::simulate_rtl(mesh, config, options)
                                              : model::simulate(mesh, config, options));
    stop_if_cancelled();
    return result;
  }

  int compare(Context& context, const std::string& scene, const model::MachineConfig& config,
              const std::vector<Party>& parties, const std::vector<Cycles>& cycles) const {
    ordered_json json = json_of_program();
    json["source"] = scene_;
    json["scene"] = scene;
    json["config"] = config.name;
    json["arrays"] = ordered_json::array();
    Table table({"stage", "array", "words", "result"});
    std::string first;
    for (const ArrayComparison& array : compare_arrays(parties, stage_)) {
      const auto at = array.first_word;
      const std::string result = at ? "differs at word " + std::to_string(*at) : "same";
      table.row({array.stage, array.name, std::to_string(array.words), result});
      json["arrays"].push_back(record(array, parties));
      if (first.empty()) first = describe(array, parties);
    }
    context.output.line("scene                {}", scene);
    context.output.line("machine              {}", config.name);
    table.print(context.output);
    print_cycles(context, cycles, json);
    context.output.line("{}", first.empty() ? "no difference" : "first difference     " + first);
    json["difference"] = first.empty() ? ordered_json(nullptr) : ordered_json(first);
    context.output.json(json, context.common.json);
    return first.empty() ? kDone : kCheckFailed;
  }

  // Both machines go through the same stages. Bit encoding has no cycles of its own: it works while
  // the internal nodes come.
  void print_cycles(Context& context, const std::vector<Cycles>& machines,
                    ordered_json& json) const {
    std::vector<std::string> head{"stage"};
    for (const Cycles& machine : machines) head.push_back(machine.name + ", cycles");
    if (machines.size() == 2) head.push_back("model off by, %");
    Table table(head);
    const auto row = [&](const std::string& name, const std::vector<std::uint64_t>& values) {
      std::vector<std::string> cells{name};
      ordered_json entry{{"stage", name}};
      for (std::size_t m = 0; m < values.size(); ++m) {
        cells.push_back(std::to_string(values[m]));
        entry[machines[m].name + "_cycles"] = values[m];
      }
      if (values.size() == 2) {
        const double rtl = static_cast<double>(values[1]);
        const double off = 100 * (static_cast<double>(values[0]) - rtl) / rtl;
        cells.push_back(rtl == 0 ? "" : fmt::format("{:+.2f}", off));
        entry["model_off_percent"] = rtl == 0 ? ordered_json(nullptr) : ordered_json(off);
      }
      table.row(cells);
      json["cycles"].push_back(entry);
    };
    json["cycles"] = ordered_json::array();
    for (std::size_t s = 0; s < machines.front().stages.size(); ++s) {
      const std::string& name = machines.front().stages[s].name;
      if (!stage_.empty() && name != stage_) continue;
      std::vector<std::uint64_t> values;
      for (const Cycles& machine : machines) {
        values.push_back(machine.stages[s].end_cycle - machine.stages[s].begin_cycle);
      }
      row(name, values);
    }
    if (stage_.empty()) {
      std::vector<std::uint64_t> values;
      for (const Cycles& machine : machines) values.push_back(machine.all);
      row("all", values);
    }
    if (!json["cycles"].empty()) table.print(context.output);
  }

  static ordered_json record(const ArrayComparison& array, const std::vector<Party>& parties) {
    ordered_json record{{"stage", array.stage},
                        {"array", array.name},
                        {"words", array.words},
                        {"same", !array.first_word}};
    if (array.first_word) record["first_word"] = *array.first_word;
    for (std::size_t p = 0; p < array.values.size(); ++p) {
      const auto value = array.values[p];
      record[parties[p].name] =
          value ? ordered_json(model::word_text(*value)) : ordered_json(nullptr);
    }
    return record;
  }

  std::string scene_;
  std::string config_ = "paper-fpga";
  std::vector<std::string> set_;
  std::string stage_;
  int rtl_ = kBoth;
};

}  // namespace

std::unique_ptr<Command> make_diff_command() {
  return std::make_unique<DiffCommand>();
}

}  // namespace fasttree::app
