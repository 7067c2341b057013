// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "inputs.h"
#include "progress.h"
#include "report/evaluation.h"

namespace fasttree::app {
namespace {

constexpr std::uint32_t kTimelineWindows = 400;
constexpr std::uint64_t kMostForChanges = 200'000;  // triangles: some 150 simulations follow

std::string remedy_for(std::string_view file) {
  if (file == "bunny") {
    return "Stanford 3D Scanning Repository (graphics.stanford.edu/data/3Dscanrep), the full "
           "resolution, as bunny.ply";
  }
  if (file == "happy_buddha") {
    return "Stanford 3D Scanning Repository (graphics.stanford.edu/data/3Dscanrep), the full "
           "resolution, as happy_buddha.ply";
  }
  if (file == "dragon") return "scripts/fetch_dragon.sh fetches it and says where it is";
  if (file == "fairy_forest") {
    return "Utah 3D Animation Repository (sci.utah.edu/~wald/animrep), one frame, as "
           "fairy_forest.obj";
  }
  return fmt::format("McGuire Computer Graphics Archive (casual-effects.com/data), as {}.obj",
                     file);
}

std::vector<DesignPoint> machines() {
  std::vector<DesignPoint> points;
  for (const char* config : {"paper-fpga", "paper-asic65", "paper-asic28", "fasttree-2"}) {
    points.push_back({config, {}, take(model::load_config(config))});
  }
  return points;
}

FrameSplitSettings frame_settings(const EvaluationSettings& settings) {
  FrameSplitSettings frame;
  frame.memory_bytes = settings.memory_bytes;
  frame.repeat = settings.repeat;
  if (!settings.quick) return frame;
  frame.width = frame.height = 256;
  frame.repeat = 1;
  frame.picture_width = 320;
  frame.picture_height = 240;
  frame.samples = 2;
  return frame;
}

/// Every scene on every machine; what a machine refuses goes to the skipped ones.
void simulate_all(Context& context, const std::vector<ExploredScene>& scenes, Evaluation& result) {
  ResultsFile nowhere("");
  const Exploration made = explore(context, result.machines, scenes, nowhere,
                                   result.settings.memory_bytes, kTimelineWindows);
  context.progress.clear();
  if (made.cancelled) throw Failure{kCancelled, "cancelled"};
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    EvaluatedScene scene;
    scene.paper = paper_of(scenes[s]);
    scene.name = scene.paper != nullptr ? scene.paper->scene : scenes[s].scene.mesh.name;
    scene.source = std::filesystem::path(scenes[s].name).filename().string();
    scene.triangles = scenes[s].scene.view.triangle_count;
    std::string refusal = scene.triangles == 0 ? "it has no triangles" : "";
    for (std::size_t m = 0; m < kMachines; ++m) {
      scene.runs.push_back(made.runs[m * scenes.size() + s]);
      const ExploredRun& run = scene.runs.back();
      if (!run.done() && refusal.empty()) refusal = run.config + " " + run.status;
    }
    if (refusal.empty()) {
      result.scenes.push_back(std::move(scene));
    } else {
      result.skipped.push_back({scene.name, refusal, "another file, or a smaller scene"});
    }
  }
  if (result.scenes.empty()) {
    throw Failure{kResourceLimit, fmt::format("no scene is left: {}: {}", result.skipped[0].scene,
                                              result.skipped[0].reason)};
  }
}

void measure_all(Context& context, const std::vector<ExploredScene>& scenes, Evaluation& result) {
  const FrameSplitSettings settings = frame_settings(result.settings);
  for (EvaluatedScene& scene : result.scenes) {
    const auto loaded = std::find_if(scenes.begin(), scenes.end(), [&](const ExploredScene& s) {
      return s.name == scene.runs.front().scene;
    });
    context.output.line("measuring and drawing {}", scene.name);
    scene.frame = split_frame(context, *loaded, settings);
    scene.same_tree =
        std::all_of(scene.runs.begin(), scene.runs.end(),
                    [&](const ExploredRun& run) { return run.tree_hash == scene.frame.tree_hash; });
  }
}

void compare_tables(Evaluation& result) {
  for (const EvaluatedScene& scene : result.scenes) {
    const auto table2 =
        reproduce_table2(scene.name, scene.paper, scene.runs[kFpga], scene.runs[kAsic65]);
    result.table2.insert(result.table2.end(), table2.begin(), table2.end());
    std::vector<LibraryTime> library;
    for (const MeasuredFrame& frame : scene.frame.library) {
      library.push_back({frame.profile, result.threads, frame.tree_ms});
    }
    const auto table3 = reproduce_table3(
        scene.name, scene.paper,
        {&scene.runs[kAsic65], &scene.runs[kAsic28], &scene.runs[kFastTree2]}, library);
    result.table3.insert(result.table3.end(), table3.begin(), table3.end());
  }
}

void name_missing(Evaluation& result) {
  for (const PaperBuild& row : paper_table2()) {
    const bool here = std::any_of(result.scenes.begin(), result.scenes.end(),
                                  [&](const EvaluatedScene& s) { return s.paper == &row; });
    const bool refused = std::any_of(result.skipped.begin(), result.skipped.end(),
                                     [&](const SkippedScene& s) { return s.scene == row.scene; });
    if (here || refused) continue;
    result.skipped.push_back(
        {row.scene, "not among the scenes given, or of another size", remedy_for(row.file)});
  }
}

/// The smallest scene of the paper, else the smallest of all, if it is small enough.
std::string scene_for_changes(const Evaluation& result) {
  if (result.settings.quick) return "scene:knot:1k";
  const EvaluatedScene* best = nullptr;
  const auto before = [](const EvaluatedScene& a, const EvaluatedScene& b) {
    return std::pair(a.paper == nullptr, a.triangles) < std::pair(b.paper == nullptr, b.triangles);
  };
  for (const EvaluatedScene& scene : result.scenes) {
    if (best == nullptr || before(scene, *best)) best = &scene;
  }
  return best->triangles <= kMostForChanges ? best->runs.front().scene : "scene:knot:20k";
}

}  // namespace

Evaluation evaluate(Context& context, const EvaluationSettings& settings) {
  Evaluation result;
  result.settings = settings;
  result.processor = processor_name();
  result.threads = context.threads;
  result.machines = machines();
  result.table1 = reproduce_table1();
  const std::vector<ExploredScene> scenes = load_scenes(context, settings.scenes);
  context.output.line("simulating {} scenes on {} machines", scenes.size(), result.machines.size());
  simulate_all(context, scenes, result);
  measure_all(context, scenes, result);
  compare_tables(result);
  name_missing(result);
  result.claims = claims_of(result);
  const std::vector<ExploredScene> changed = load_scenes(context, {scene_for_changes(result)});
  for (const Machine machine : {kAsic65, kFastTree2}) {
    context.output.line("changing the assumptions of {} one by one, on {}",
                        result.machines[machine].label, changed.front().scene.mesh.name);
    result.sensitivities.push_back(
        sensitivity_of(context, result.machines[machine], changed, settings.memory_bytes));
  }
  return result;
}

}  // namespace fasttree::app
