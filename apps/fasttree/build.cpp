// SPDX-License-Identifier: Apache-2.0
// fasttree build: from a scene to a tree, with times and quality.
#include "fasttree/build.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "devices.h"
#include "fasttree/quality.h"
#include "fasttree/tree_file.h"
#include "inputs.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "resident.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

class BuildCommand : public Command {
 public:
  const char* name() const override { return "build"; }
  const char* summary() const override { return "Build a scene's kd-tree"; }
  const char* details() const override {
    return "Prints the time of each stage, the tree's quality and a hash of its bytes: equal "
           "trees\n"
           "have equal hashes, for any number of threads and any instruction set.\n\n"
           "Example:\n"
           "  fasttree build bunny.ply --out bunny.ft --json figures.json\n"
           "  fasttree build bunny.ply --device udp://127.0.0.1:18004";
  }

  void declare(Options& options) override {
    options.positional(scene_, "SCENE", "A mesh file, or scene:NAME");
    build_.declare(options);
    device_.declare(options);
    options.count(repeat_, "--repeat", "Builds in the same memory; times are their medians", 1,
                  100000);
    options.text(out_, "--out", "FILE", "Save the tree");
  }

  int run(Context& context) override {
    const LoadedScene scene = load_scene(context, scene_, build_.settings.memory_limit_bytes);
    Tree tree;
    std::optional<DeviceTree> built;
    const Times times = device_.given() ? build_on_device(context, scene.view, tree, built)
                                        : build_repeatedly(context, scene.view, tree);
    const Quality quality = measure_quality(tree, build_.settings.sah_costs);
    double save_ms = 0;
    if (!out_.empty()) {
      const auto start = std::chrono::steady_clock::now();
      check(save_tree(tree, out_));
      save_ms = milliseconds_since(start);
    }
    context.progress.clear();
    if (built) print_device(context.output, *built);
    print(context.output, scene, tree, times, quality);
    ordered_json figures = json(context, scene, tree, times, quality, save_ms);
    if (built) figures["device"] = app::json_of(*built);
    context.output.json(figures, context.common.json);
    return kDone;
  }

 private:
  struct Times {
    std::vector<double> builds;
    std::vector<StageTime> stages;  ///< medians
    std::uint64_t planned_bytes = 0;
    std::optional<std::uint64_t> resident_bytes;  ///< most that the builds added
  };

  Times build_repeatedly(Context& context, const MeshView& mesh, Tree& tree) const {
    Times times;
    const ResidentPeak resident;
    Builder builder;
    std::vector<std::vector<double>> stage_times;
    for (std::uint32_t i = 0; i < repeat_; ++i) {
      const std::string what =
          repeat_ > 1 ? fmt::format("build {} of {}:", i + 1, repeat_) : std::string("building");
      check(builder.build(mesh, build_.with_progress(context, what), tree));
      const BuildStats& stats = builder.stats();
      times.builds.push_back(stats.build_ms);
      times.planned_bytes = stats.planned_bytes;
      times.stages = stats.stages;
      stage_times.resize(stats.stages.size());
      for (std::size_t s = 0; s < stats.stages.size(); ++s) {
        stage_times[s].push_back(stats.stages[s].ms);
      }
      stop_if_cancelled();
    }
    times.resident_bytes = resident.grown();
    for (std::size_t s = 0; s < times.stages.size(); ++s) {
      times.stages[s].ms = median(stage_times[s]);
    }
    return times;
  }

  Times build_on_device(Context& context, const MeshView& mesh, Tree& tree,
                        std::optional<DeviceTree>& built) const {
    Times times;
    for (std::uint32_t i = 0; i < repeat_; ++i) {
      built = device_.build(context, mesh, build_.settings);
      times.builds.push_back(built->counters.build_ms);
    }
    check_tree_of(*built, mesh);
    tree = built->tree;
    return times;
  }

  void print(Output& output, const LoadedScene& scene, const Tree& tree, const Times& times,
             const Quality& quality) const {
    const TreeInfo& info = tree.info();
    output.line("scene                {} ({} triangles, read in {:.1f} ms)", scene.mesh.name,
                with_commas(info.triangle_count), scene.load_ms);
    if (info.profile == Profile::paper) {
      output.line("profile              {}, {} axes, depth {}", to_string(info.profile),
                  to_string(info.axes), info.depth);
    } else {
      output.line("profile              {}", to_string(info.profile));
    }
    const double build_ms = median(times.builds);
    output.line("build                {:.2f} ms{}{}", build_ms,
                repeat_ > 1 ? fmt::format(" (median of {})", repeat_) : "",
                info.triangle_count > 0
                    ? fmt::format(", {:.1f} ns a triangle", build_ms * 1e6 / info.triangle_count)
                    : "");
    for (const StageTime& stage : times.stages) {
      output.line("  {:<18} {:.2f} ms", stage.stage, stage.ms);
    }
    print_quality(output, quality);
    const std::string tree_bytes = bytes_text(tree.nodes().size_bytes() + tree.ids().size_bytes());
    if (device_.given()) {
      output.line("memory               {} of tree", tree_bytes);
    } else {
      output.line("memory               {} planned{} (the tree itself {})",
                  bytes_text(times.planned_bytes),
                  times.resident_bytes
                      ? fmt::format(", {} used at the peak", bytes_text(*times.resident_bytes))
                      : "",
                  tree_bytes);
    }
    output.line("hash                 {}", hash_string(tree.hash()));
    if (!out_.empty()) output.line("saved                {}", out_);
  }

  ordered_json json(const Context& context, const LoadedScene& scene, const Tree& tree,
                    const Times& times, const Quality& quality, double save_ms) const {
    const TreeInfo& info = tree.info();
    ordered_json stages = ordered_json::array();
    for (const StageTime& stage : times.stages) {
      stages.push_back({{"stage", stage.stage}, {"time_ms", stage.ms}});
    }
    ordered_json json = json_of_program();
    json["scene"] = scene.mesh.name;
    json["source"] = scene_;
    json["profile"] = to_string(info.profile);
    json["axes"] =
        info.profile == Profile::paper ? ordered_json(to_string(info.axes)) : ordered_json(nullptr);
    json["implementation"] =
        build_.settings.implementation == Implementation::fast ? "fast" : "reference";
    json["simd"] = build_.settings.simd == Simd::scalar ? "scalar" : "widest";
    json["threads"] = context.threads;
    json["triangles"] = info.triangle_count;
    json["vertices"] = scene.view.vertex_count;
    json["depth"] = info.depth;
    json["bits"] = info.bits;
    json["bounds"] = json_of(info.bounds);
    json["references"] = tree.ids().size();
    json["leaves"] = tree.leaf_count();
    json["nodes"] = tree.nodes().size();
    json["build_ms"] = median(times.builds);
    json["build_ms_all"] = times.builds;
    json["load_ms"] = scene.load_ms;
    if (!out_.empty()) {
      json["save_ms"] = save_ms;
      json["tree_file"] = out_;
    }
    json["stages"] = stages;
    json["planned_bytes"] =
        device_.given() ? ordered_json(nullptr) : ordered_json(times.planned_bytes);
    json["peak_resident_bytes"] =
        times.resident_bytes ? ordered_json(*times.resident_bytes) : ordered_json(nullptr);
    json["tree_bytes"] = tree.nodes().size_bytes() + tree.ids().size_bytes();
    json["tree_hash"] = hash_string(tree.hash());
    json["quality"] = json_of(quality);
    return json;
  }

  std::string scene_;
  BuildOptions build_;
  DeviceOptions device_;
  std::uint32_t repeat_ = 1;
  std::string out_;
};

}  // namespace

std::unique_ptr<Command> make_build_command() {
  return std::make_unique<BuildCommand>();
}

}  // namespace fasttree::app
