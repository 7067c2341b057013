// SPDX-License-Identifier: Apache-2.0
// fasttree info: what is in a scene or a tree file, and what this program can do.
#include <hwy/highway.h>
#include <oneapi/tbb/version.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "fasttree/tree_file.h"
#include "grid/grid.h"
#include "inputs.h"
#include "model/config/machine_config.h"
#include "options.h"
#include "oracle/embree_oracle.h"
#include "output.h"
#include "reference/scene_bound.h"
#include "scene/procedural/procedural.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

/// Instruction sets this program was compiled for and this processor has, best first.
std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
    names.push_back(hwy::TargetName(rest & -rest));
  }
  return names;
}

/// M(D) of one schedule and the depth that the rule picks.
struct Counts {
  AxisLevels levels;
  ReferenceCounts counts;
  Result<int> depth = 0;
};

Counts count(const MeshView& mesh, const Box3& bounds, AxisSchedule axes) {
  Counts result;
  result.levels = make_axis_levels(bounds, axes);
  result.counts = count_references(mesh, bounds, axes);
  BuildSettings settings;
  settings.axes = axes;
  result.depth = choose_depth(result.counts, mesh.triangle_count, settings);
  return result;
}

ordered_json json_of(const Counts& counts) {
  ordered_json references = ordered_json::array();
  for (int d = 0; d <= counts.counts.levels; ++d) {
    references.push_back(counts.counts.at[static_cast<std::size_t>(d)]);
  }
  ordered_json json = {{"levels", counts.counts.levels}};
  if (counts.depth.ok()) {
    json["depth"] = counts.depth.value();
    json["bits"] = counts.levels.bits(counts.depth.value());
  } else {
    json["depth"] = nullptr;
  }
  json["references_by_depth"] = references;
  return json;
}

class InfoCommand : public Command {
 public:
  const char* name() const override { return "info"; }
  const char* summary() const override { return "What is in a scene or a tree file"; }
  const char* details() const override {
    return "For a scene: triangles, bounds, axes, and how many references a grid of each depth\n"
           "would make. For a tree file: what it says of itself, and its quality. Without either:\n"
           "the program's version, instruction sets and libraries.\n\n"
           "Example:\n  fasttree info bunny.ply\n  fasttree info --list";
  }

  void declare(Options& options) override {
    options.positional(input_, "SCENE|TREE", "A scene or a tree file", false);
    options.flag(list_, "--list", "List the procedural scenes");
    options.text(config_, "--config", "NAME|FILE", "Print a machine's configuration as TOML");
  }

  int run(Context& context) override {
    ordered_json json = json_of_program();
    if (!config_.empty()) {
      const std::string toml = model::to_toml(take(model::load_config(config_)));
      context.output.line("{}", std::string_view(toml).substr(0, toml.size() - 1));
      json["config"] = toml;
    } else if (list_) {
      list_scenes(context.output, json);
    } else if (input_.empty()) {
      describe_program(context, json);
    } else if (is_tree_file(input_)) {
      describe_tree(context.output, json);
    } else {
      describe_scene(context, json);
    }
    context.output.json(json, context.common.json);
    return kDone;
  }

 private:
  static void list_scenes(Output& output, ordered_json& json) {
    json["scenes"] = ordered_json::array();
    for (const scene::ProceduralInfo& info : scene::procedural_scenes()) {
      output.line("scene:{:<12} {:>9} triangles{}  {}", info.name,
                  with_commas(info.default_triangles),
                  info.frames > 1 ? fmt::format(", {:>2} frames", info.frames) : "           ",
                  info.description);
      json["scenes"].push_back({{"name", std::string("scene:") + info.name},
                                {"description", info.description},
                                {"default_triangles", info.default_triangles},
                                {"frames", info.frames},
                                {"interior", info.interior}});
    }
    output.line("");
    output.line("A size may follow, and for animated scenes a frame: scene:NAME:TRIANGLES:FRAME");
  }

  static void describe_program(Context& context, ordered_json& json) {
    const auto targets = simd_targets();
    context.output.line("fasttree             {}", FASTTREE_VERSION);
    context.output.line("instruction sets     {}", fmt::join(targets, ", "));
    context.output.line("threads              {}", context.threads);
    context.output.line("oneTBB               {}", TBB_runtime_version());
    context.output.line("Embree               {}", oracle::embree_version());
    json["simd_targets"] = targets;
    json["threads"] = context.threads;
    json["tbb"] = TBB_runtime_version();
    json["embree"] =
        oracle::embree_available() ? ordered_json(oracle::embree_version()) : ordered_json(nullptr);
  }

  void describe_tree(Output& output, ordered_json& json) const {
    const Tree tree = load_checked_tree(input_);
    const TreeInfo& info = tree.info();
    const Quality quality = measure_quality(tree);
    const std::uint64_t bytes = tree.nodes().size_bytes() + tree.ids().size_bytes();
    output.line("tree                 {}", input_);
    output.line("profile              {}", to_string(info.profile));
    if (info.profile == Profile::paper) {
      output.line("grid                 {} axes, depth {} ({} + {} + {} bits)",
                  to_string(info.axes), info.depth, info.bits[0], info.bits[1], info.bits[2]);
    }
    output.line("triangles            {}", with_commas(info.triangle_count));
    output.line("bounds               {}", text_of(info.bounds));
    print_quality(output, quality);
    output.line("memory               {}", bytes_text(bytes));
    output.line("hash                 {}", hash_string(tree.hash()));
    json["tree"] = app::json_of(info);
    json["tree"]["file"] = input_;
    json["tree"]["tree_bytes"] = bytes;
    json["tree"]["tree_hash"] = hash_string(tree.hash());
    json["quality"] = app::json_of(quality);
  }

  void describe_scene(Context& context, ordered_json& json) const {
    Output& output = context.output;
    const LoadedScene scene = load_scene(context, input_, most_of_memory());
    const MeshView& mesh = scene.view;
    check(validate(mesh));
    const Box3 bounds = take(reference::scene_bound(mesh));
    const Counts cyclic = count(mesh, bounds, AxisSchedule::cyclic);
    const Counts longest = count(mesh, bounds, AxisSchedule::longest);

    std::string live;
    ordered_json live_json = ordered_json::array();
    for (std::size_t a = 0; a < 3; ++a) {
      if (!cyclic.levels.live[a]) continue;
      live += (live.empty() ? "" : ", ") + std::string(1, "xyz"[a]);
      live_json.push_back(std::string(1, "xyz"[a]));
    }
    output.line("scene                {}", scene.mesh.name);
    output.line("triangles            {}", with_commas(mesh.triangle_count));
    output.line("vertices             {}{}", with_commas(mesh.vertex_count),
                mesh.indices == nullptr ? " (no indices)" : "");
    output.line("bounds               {}", text_of(bounds));
    output.line("live axes            {}", live.empty() ? "none" : live);
    output.line("read in              {:.1f} ms", scene.load_ms);
    print_counts(output, mesh.triangle_count, cyclic, longest);

    json["scene"] = {{"name", scene.mesh.name},
                     {"source", input_},
                     {"triangles", mesh.triangle_count},
                     {"vertices", mesh.vertex_count},
                     {"indexed", mesh.indices != nullptr},
                     {"bounds", app::json_of(bounds)},
                     {"live_axes", live_json},
                     {"load_ms", scene.load_ms}};
    json["cyclic"] = json_of(cyclic);
    json["longest"] = json_of(longest);
  }

  static void print_counts(Output& output, std::uint32_t triangles, const Counts& cyclic,
                           const Counts& longest) {
    output.line("");
    output.line("References that a grid of depth D makes (*: the depth chosen by itself)");
    Table table({"D", "cyclic", "a triangle", " ", "longest", "a triangle", " "});
    const auto cells = [&](std::vector<std::string>& row, const Counts& c, int d) {
      if (d > c.counts.levels) {
        row.insert(row.end(), {"", "", " "});
        return;
      }
      const std::uint64_t m = c.counts.at[static_cast<std::size_t>(d)];
      row.push_back(with_commas(m));
      row.push_back(triangles > 0 ? fmt::format("{:.2f}", static_cast<double>(m) / triangles)
                                  : std::string("-"));
      row.push_back(c.depth.ok() && c.depth.value() == d ? "*" : " ");
    };
    for (int d = 0; d <= std::max(cyclic.counts.levels, longest.counts.levels); ++d) {
      std::vector<std::string> row = {std::to_string(d)};
      cells(row, cyclic, d);
      cells(row, longest, d);
      table.row(row);
    }
    table.print(output);
  }

  std::string input_;
  std::string config_;
  bool list_ = false;
};

}  // namespace

std::unique_ptr<Command> make_info_command() {
  return std::make_unique<InfoCommand>();
}

}  // namespace fasttree::app
