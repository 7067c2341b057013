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
using model::StageArray;
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
           "word that differs is where to look for the fault. Exit 1 where one is found.\n\n"
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
    if (rtl_ != kRtl) parties.push_back({"model", simulated(context, scene.view, config, false)});
    if (rtl_ != kModel) parties.push_back({"rtl", simulated(context, scene.view, config, true)});
    context.progress.clear();
    return compare(context, scene.mesh.name, config, parties);
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

  static std::vector<StageArray> simulated(Context& context, const MeshView& mesh,
                                           const model::MachineConfig& config, bool rtl) {
    model::SimulationOptions options;
    options.keep_arrays = true;
    options.keep_broken = true;
    options.timeline_windows = 0;
    options.progress = context.progress.callback(rtl ? "RTL:" : "model:");
    const model::SimulationResult result = take(rtl ? rtl::simulate_rtl(mesh, config, options)
                                                    : model::simulate(mesh, config, options));
    stop_if_cancelled();
    return stage_arrays(result);
  }

  int compare(Context& context, const std::string& scene, const model::MachineConfig& config,
              const std::vector<Party>& parties) const {
    ordered_json json = json_of_program();
    json["source"] = scene_;
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
    context.output.line("{}", first.empty() ? "no difference" : "first difference     " + first);
    json["difference"] = first.empty() ? ordered_json(nullptr) : ordered_json(first);
    context.output.json(json, context.common.json);
    return first.empty() ? kDone : kCheckFailed;
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
