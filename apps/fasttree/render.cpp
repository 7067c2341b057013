// SPDX-License-Identifier: Apache-2.0
// fasttree render: a picture of a scene, of what its tracing costs, or of its tree.
#include "render/render.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "command.h"
#include "devices.h"
#include "fasttree/build.h"
#include "fasttree/tree_file.h"
#include "fasttree/verify.h"
#include "inputs.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "views.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

ordered_json json_of(const render::RayStats& stats) {
  return {{"rays", stats.rays},
          {"time_ms", stats.ms},
          {"mrays_per_s", stats.mrays_per_s()},
          {"inner_steps", stats.counters.inner_steps},
          {"leaf_visits", stats.counters.leaf_visits},
          {"triangle_tests", stats.counters.triangle_tests}};
}

class RenderCommand : public Command {
 public:
  const char* name() const override { return "render"; }
  const char* summary() const override { return "Draw a scene through its tree, as a PNG"; }
  const char* details() const override {
    return "Mode shaded draws the scene, heat what each pixel's ray costs, leaves the tree's "
           "leaves\n"
           "cut by a plane. Without camera options the view is chosen from the scene.\n\n"
           "Example:\n"
           "  fasttree render scene:knot --size 1280x720 --samples 4 --ao 16 --out knot.png\n"
           "  fasttree render bunny.ply --mode heat --out heat.png\n"
           "  fasttree render bunny.ply --device udp://127.0.0.1:18004 --out bunny.png";
  }

  void declare(Options& options) override {
    options.positional(input_, "SCENE|TREE", "A scene, or a tree file with --mesh");
    options.text(mesh_, "--mesh", "SCENE", "The scene that the tree file was built for");
    options.text(out_, "--out", "FILE", "The picture");
    options.extent(settings_.width, settings_.height, "--size", "Pixels", 32768);
    options.choice(settings_.mode, "--mode", "What to draw",
                   Choices<render::Mode>{{"shaded", render::Mode::shaded},
                                         {"heat", render::Mode::heat},
                                         {"leaves", render::Mode::leaves}});
    camera_.declare(options);
    options.count(settings_.samples, "--samples", "Primary rays a pixel", 1, 4096);
    options.flag_pair(settings_.smooth, "--smooth", "--flat",
                      "Shade with vertex normals (the default)", "Shade with triangle normals");
    options.flag_pair(settings_.shadows, "--shadows", "--no-shadows",
                      "Trace shadow rays (the default)", "Trace none");
    options.flag(settings_.ground, "--ground", "Draw a floor under the scene");
    options.point(settings_.light, "--light",
                  "Where the light is; else above the camera, where it lights most");
    options.number(light_radius_, "--light-radius", "Size of the light, for soft shadows", 0, 1e30);
    options.count(settings_.ao_samples, "--ao", "Ambient-occlusion rays a hit", 0, 4096);
    options.number(ao_radius_, "--ao-radius",
                   "How far they reach; else a tenth of the scene or less", 0, 1e30);
    options.number(settings_.heat_max, "--heat-max",
                   "Cost at the top of the heat map's scale; 0: chosen from the picture", 0, 1e12);
    options.choice(settings_.slice_axis, "--slice-axis",
                   "Mode leaves: the axis that the plane is perpendicular to",
                   Choices<std::uint32_t>{{"x", 0}, {"y", 1}, {"z", 2}});
    options.number(slice_position_, "--slice", "Mode leaves: where the plane is; else the middle",
                   -1e30, 1e30);
    build_.declare(options);
    device_.declare(options);
  }

  int run(Context& context) override {
    if (out_.empty()) {
      throw Failure{kUsage, "render needs a file for the picture; give --out FILE.png"};
    }
    const bool from_file = is_tree_file(input_);
    if (from_file && mesh_.empty()) {
      throw Failure{kUsage, fmt::format("'{}' is a tree file; give its scene with --mesh", input_)};
    }
    if (!from_file && !mesh_.empty()) {
      throw Failure{kUsage, fmt::format("--mesh goes with a tree file, and '{}' is none", input_)};
    }
    if (from_file && device_.given()) {
      throw Failure{kUsage, fmt::format("--device goes with a scene, and '{}' is a tree", input_)};
    }
    const std::string& spec = from_file ? mesh_ : input_;
    const LoadedScene scene = load_scene(context, spec, build_.settings.memory_limit_bytes);
    Tree tree;
    double build_ms = 0;
    std::optional<DeviceTree> built;
    if (from_file) {
      tree = load_tree_for(scene.view);
    } else if (device_.given()) {
      built = device_.build(context, scene.view, build_.settings);
      check_tree_of(*built, scene.view);
      tree = built->tree;
      build_ms = built->counters.build_ms;
    } else {
      Builder builder;
      check(builder.build(scene.view, build_.with_progress(context), tree));
      build_ms = builder.stats().build_ms;
    }
    const Tracer tracer = make_tracer(tree, scene.view);

    settings_.camera = camera_.choose(spec, tree.info().bounds, tracer);
    settings_.memory_limit_bytes = build_.settings.memory_limit_bytes;
    settings_.progress = context.progress.callback("drawing");
    if (light_radius_) settings_.light_radius = static_cast<float>(*light_radius_);
    if (ao_radius_) settings_.ao_radius = static_cast<float>(*ao_radius_);
    if (slice_position_) settings_.slice_position = static_cast<float>(*slice_position_);
    render::RenderStats stats;
    const render::Image image = take(render::render(tree, tracer, scene.view, settings_, &stats));
    check(render::write_png(image, out_));
    context.progress.clear();

    if (built) print_device(context.output, *built);
    print(context.output, scene, build_ms, stats);
    ordered_json json = json_of_program();
    json["scene"] = scene.mesh.name;
    json["triangles"] = scene.view.triangle_count;
    json["picture"] = out_;
    json["mode"] = to_string(settings_.mode);
    json["width"] = settings_.width;
    json["height"] = settings_.height;
    json["samples"] = settings_.samples;
    json["camera"] = app::json_of(settings_.camera);
    json["threads"] = context.threads;
    json["load_ms"] = scene.load_ms;
    if (!from_file) json["build_ms"] = build_ms;
    if (built) json["device"] = app::json_of(*built);
    json["render_ms"] = stats.total_ms;
    json["mrays_per_s"] = stats.mrays_per_s;
    json["primary"] = json_of(stats.primary);
    json["shadow"] = json_of(stats.shadow);
    json["ao"] = json_of(stats.ao);
    json["hit_pixels"] = stats.hit_pixels;
    json["scale_max"] = stats.scale_max;
    json["mean_cost"] = stats.mean_cost;
    context.output.json(json, context.common.json);
    return kDone;
  }

 private:
  Tree load_tree_for(const MeshView& mesh) const {
    Tree tree = take(load_tree(input_));
    const Verification verification = verify(tree, mesh);
    if (!verification.ok) {
      throw Failure{kBadInput,
                    fmt::format("{} is not a right tree for {}: it breaks '{}': {}", input_, mesh_,
                                verification.invariant, verification.detail)};
    }
    return tree;
  }

  void print(Output& output, const LoadedScene& scene, double build_ms,
             const render::RenderStats& stats) const {
    output.line("scene                {} ({} triangles)", scene.mesh.name,
                with_commas(scene.view.triangle_count));
    if (build_ms > 0) output.line("build                {:.2f} ms", build_ms);
    if (settings_.mode == render::Mode::leaves) {
      output.line("drawn in             {:.1f} ms", stats.total_ms);
    } else {
      output.line("camera               {}", text_of(settings_.camera));
      output.line("drawn in             {:.1f} ms ({:.2f} million rays a second)", stats.total_ms,
                  stats.mrays_per_s);
    }
    if (settings_.mode == render::Mode::heat) {
      output.line("cost                 {:.1f} nodes and tests a pixel; the scale ends at {:.0f}",
                  stats.mean_cost, stats.scale_max);
    }
    output.line("picture              {} ({} x {})", out_, settings_.width, settings_.height);
  }

  std::string input_;
  std::string mesh_;
  std::string out_;
  render::RenderSettings settings_;
  CameraOptions camera_;
  BuildOptions build_;
  DeviceOptions device_;
  std::optional<double> light_radius_;
  std::optional<double> ao_radius_;
  std::optional<double> slice_position_;
};

}  // namespace

std::unique_ptr<Command> make_render_command() {
  return std::make_unique<RenderCommand>();
}

}  // namespace fasttree::app
