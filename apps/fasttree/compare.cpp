// SPDX-License-Identifier: Apache-2.0
// fasttree compare: the builders against each other, on the same scene and the same rays.
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chart.h"
#include "command.h"
#include "fasttree/build.h"
#include "fasttree/quality.h"
#include "inputs.h"
#include "measure.h"
#include "options.h"
#include "oracle/embree_oracle.h"
#include "output.h"
#include "progress.h"
#include "views.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

/// A builder, the tree it made and what was measured of it.
struct Contender {
  std::string name;
  BuildSettings settings;
  Builder builder;
  Tree tree;
  std::optional<oracle::EmbreeScene> embree;  ///< instead of builder and tree
  std::optional<Tracer> tracer;
  RayCaster caster;
  Quality quality;
  std::vector<double> build_ms;
  std::array<std::vector<double>, kRayKinds.size()> trace_ms;
  std::array<TraceCounters, kRayKinds.size()> counters;

  bool is_embree() const { return embree.has_value(); }
};

struct Named {
  const char* name;
  Profile profile;
  AxisSchedule axes;
};

constexpr std::array kBuilders = {Named{"paper-cyclic", Profile::paper, AxisSchedule::cyclic},
                                  Named{"paper-longest", Profile::paper, AxisSchedule::longest},
                                  Named{"sah-binned", Profile::sah_binned, AxisSchedule::cyclic},
                                  Named{"sah-exact", Profile::sah_exact, AxisSchedule::cyclic}};
constexpr const char* kEmbree = "embree";

double mrays_per_s(std::size_t rays, double ms) {
  return ms > 0 ? static_cast<double>(rays) / (ms * 1e3) : 0;
}

bool same_bits(const Hit& a, const Hit& b) {
  return a.triangle == b.triangle &&
         std::bit_cast<std::uint32_t>(a.t) == std::bit_cast<std::uint32_t>(b.t);
}

class CompareCommand : public Command {
 public:
  const char* name() const override { return "compare"; }
  const char* summary() const override {
    return "Measure the builders against each other on a scene";
  }
  const char* details() const override {
    return "Builds with each builder and traces the same rays through each tree, taking turns;\n"
           "figures are medians over the rounds. All trees have to find the same hits, to the "
           "bit,\n"
           "or the exit is 1. Embree's hierarchy, where Embree is there, is not a kd-tree: it is\n"
           "shown as a yardstick.\n"
           "Builders: paper-cyclic, paper-longest, sah-binned, sah-exact, embree.\n\n"
           "Example:\n"
           "  fasttree compare bunny.ply --repeat 9 --json bunny.json --svg bunny.svg";
  }

  void declare(Options& options) override {
    memory_limit_ = most_of_memory();
    options.positional(scene_, "SCENE", "A mesh file, or scene:NAME");
    options.text(builders_, "--builders", "LIST",
                 "Which, such as paper-cyclic,sah-binned; else all");
    options.count(rounds_, "--repeat", "Rounds of building and tracing", 1, 10000);
    options.extent(width_, height_, "--size", "Primary rays", 4096);
    options.depth(depth_, "--depth", "Levels of the grid (profile paper)", 30);
    camera_.declare(options);
    options.size(memory_limit_, "--memory-limit",
                 "Memory a build may take, such as 512M; 0: no limit", bytes_text(memory_limit_));
    options.text(csv_, "--csv", "FILE", "Write the table as CSV");
    options.text(svg_, "--svg", "FILE", "Draw the figures as a bar chart");
  }

  int run(Context& context) override {
    const LoadedScene scene = load_scene(context, scene_, memory_limit_);
    std::vector<Contender> contenders = choose_contenders();
    ProgressCallback progress = context.progress.callback("comparing");
    const double steps = static_cast<double>(rounds_) * static_cast<double>(contenders.size());
    MeasuredRays rays;
    render::Camera camera;
    std::array<Traced, kRayKinds.size()> expected;
    std::string wrong;
    for (std::uint32_t round = 0; round < rounds_; ++round) {
      for (std::size_t i = 0; i < contenders.size(); ++i) {
        Contender& c = contenders[i];
        const double done = static_cast<double>(round) * static_cast<double>(contenders.size()) +
                            static_cast<double>(i);
        if (!progress(c.name.c_str(), done / steps)) stop_if_cancelled();
        build(c, scene.view);
        if (round == 0 && i == 0) {
          camera = camera_.choose(scene_, c.tree.info().bounds, *c.tracer);
          rays = make_measured_rays(camera, width_, height_, scene.view, c.tree.info().bounds,
                                    *c.tracer);
        }
        if (round == 0 && i == 0) drop_embree_where_it_cannot(context.output, contenders, rays);
        if (round == 0 && !c.is_embree()) study(c, rays);
        const std::string difference = trace(c, rays, expected, i == 0 && round == 0);
        if (wrong.empty()) wrong = difference;
      }
    }
    context.progress.clear();
    print(context.output, scene, contenders, rays);
    if (!csv_.empty()) context.output.file(table(contenders, rays).csv(), csv_);
    if (!svg_.empty()) context.output.file(chart(scene, contenders, rays), svg_);
    context.output.json(json(context, scene, contenders, rays, camera, wrong), context.common.json);
    if (!wrong.empty()) {
      std::fputs(fmt::format("fasttree: error: {}\n", wrong).c_str(), stderr);
      return kCheckFailed;
    }
    return kDone;
  }

 private:
  static std::vector<std::string> builder_names() {
    std::vector<std::string> names;
    for (const Named& named : kBuilders) names.push_back(named.name);
    return names;
  }

  std::vector<std::string> chosen_names() const {
    std::vector<std::string> valid = builder_names();
    valid.push_back(kEmbree);
    if (builders_.empty()) {
      if (!oracle::embree_available()) valid.pop_back();
      return valid;
    }
    std::vector<std::string> names;
    for (std::size_t begin = 0; begin <= builders_.size();) {
      const std::size_t end = std::min(builders_.find(',', begin), builders_.size());
      const std::string name = builders_.substr(begin, end - begin);
      begin = end + 1;
      if (std::find(valid.begin(), valid.end(), name) == valid.end()) {
        const std::string near = nearest(name, valid);
        throw Failure{kUsage, fmt::format("--builders cannot have '{}'; give some of {}{}", name,
                                          fmt::join(valid, ", "),
                                          near.empty() ? "" : "; did you mean " + near + "?")};
      }
      if (name == kEmbree && !oracle::embree_available()) {
        throw Failure{kUsage, "--builders: this program was built without Embree"};
      }
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    // The camera and the expected hits come from the first, which has to be a tree.
    std::stable_partition(names.begin(), names.end(), [](const auto& n) { return n != kEmbree; });
    if (names[0] == kEmbree) {
      throw Failure{kUsage, "--builders needs a kd-tree builder beside embree"};
    }
    return names;
  }

  std::vector<Contender> choose_contenders() const {
    std::vector<Contender> contenders;
    for (const std::string& name : chosen_names()) {
      Contender c;
      c.name = name;
      for (const Named& named : kBuilders) {
        if (name != named.name) continue;
        c.settings.profile = named.profile;
        c.settings.axes = named.axes;
      }
      c.settings.depth = depth_;
      c.settings.memory_limit_bytes = memory_limit_;
      c.settings.progress = [](const char*, double) { return !cancelled(); };
      contenders.push_back(std::move(c));
    }
    return contenders;
  }

  /// Embree, which comes last, misses everything where coordinates are too large for it.
  static void drop_embree_where_it_cannot(Output& output, std::vector<Contender>& contenders,
                                          const MeasuredRays& rays) {
    if (contenders.back().name != kEmbree) return;
    for (const auto& kind : rays.rays) {
      if (std::all_of(kind.begin(), kind.end(), oracle::EmbreeScene::accepts)) continue;
      contenders.pop_back();
      output.line("without Embree: it does not take coordinates as large as this scene's");
      return;
    }
  }

  static void build(Contender& c, const MeshView& mesh) {
    if (c.name == kEmbree) {
      c.embree.emplace(take(oracle::EmbreeScene::create(mesh, true)));
      c.build_ms.push_back(c.embree->build_ms());
      c.caster.closest = [&c](std::span<const Ray> rays, std::span<Hit> hits) {
        each(rays.size(), [&](std::size_t i) { hits[i] = c.embree->closest(rays[i]); });
      };
      c.caster.occluded = [&c](std::span<const Ray> rays, std::span<std::uint8_t> flags) {
        each(rays.size(), [&](std::size_t i) { flags[i] = c.embree->occluded(rays[i]); });
      };
      return;
    }
    check(c.builder.build(mesh, c.settings, c.tree));
    c.build_ms.push_back(c.builder.stats().build_ms);
    c.tracer.emplace(make_tracer(c.tree, mesh));
    c.caster.closest = [&c](std::span<const Ray> rays, std::span<Hit> hits) {
      c.tracer->closest(rays, hits);
    };
    c.caster.occluded = [&c](std::span<const Ray> rays, std::span<std::uint8_t> flags) {
      c.tracer->occluded(rays, flags);
    };
  }

  template <typename Body>
  static void each(std::size_t n, const Body& body) {
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, n, 256),
                              [&](const auto& range) {
                                for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                              });
  }

  static void study(Contender& c, const MeasuredRays& rays) {
    c.quality = measure_quality(c.tree, c.settings.sah_costs);
    for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
      c.counters[k] = count_rays(*c.tracer, kRayKinds[k], rays.of(kRayKinds[k]));
    }
  }

  /// Traces all kinds. The first contender's hits become the expected ones; of a later tree that
  /// finds others, says so.
  static std::string trace(Contender& c, const MeasuredRays& rays,
                           std::array<Traced, kRayKinds.size()>& expected, bool first) {
    std::string wrong;
    for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
      stop_if_cancelled();
      Traced traced;
      c.trace_ms[k].push_back(time_rays(c.caster, kRayKinds[k], rays.of(kRayKinds[k]), traced));
      if (first) expected[k] = traced;
      if (c.is_embree()) continue;  // equal within rounding only
      if (!std::equal(traced.hits.begin(), traced.hits.end(), expected[k].hits.begin(),
                      expected[k].hits.end(), same_bits) ||
          traced.flags != expected[k].flags) {
        wrong = fmt::format(
            "the tree of {} finds other hits for {} rays than the first one; run "
            "fasttree verify to see which is wrong",
            c.name, to_string(kRayKinds[k]));
      }
    }
    return wrong;
  }

  static Table table(const std::vector<Contender>& contenders, const MeasuredRays& rays) {
    Table table({"builder", "build ms", "nodes", "refs/tri", "SAH cost", "primary Mray/s",
                 "shadow Mray/s", "diffuse Mray/s", "nodes/primary", "tests/primary",
                 "nodes/diffuse", "tests/diffuse"});
    for (const Contender& c : contenders) {
      std::vector<std::string> row = {c.name, fmt::format("{:.2f}", median(c.build_ms))};
      const auto figure = [&](const std::string& text) {
        row.push_back(c.is_embree() ? "-" : text);
      };
      figure(std::to_string(c.quality.nodes));
      figure(fmt::format("{:.3f}", c.quality.references_per_triangle));
      figure(fmt::format("{:.1f}", c.quality.sah_cost));
      for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
        row.push_back(
            fmt::format("{:.3f}", mrays_per_s(rays.rays[k].size(), median(c.trace_ms[k]))));
      }
      for (const RayKind kind : {RayKind::primary, RayKind::diffuse}) {
        const TraceCounters& n = c.counters[static_cast<std::size_t>(kind)];
        const double count = static_cast<double>(std::max<std::size_t>(1, rays.of(kind).size()));
        figure(fmt::format("{:.1f}", static_cast<double>(n.inner_steps + n.leaf_visits) / count));
        figure(fmt::format("{:.1f}", static_cast<double>(n.triangle_tests) / count));
      }
      table.row(row);
    }
    return table;
  }

  void print(Output& output, const LoadedScene& scene, const std::vector<Contender>& contenders,
             const MeasuredRays& rays) const {
    output.line("{}: {} triangles; {} primary, {} shadow, {} diffuse rays; medians of {}",
                scene.mesh.name, with_commas(scene.view.triangle_count),
                with_commas(rays.rays[0].size()), with_commas(rays.rays[1].size()),
                with_commas(rays.rays[2].size()), rounds_);
    output.line("");
    table(contenders, rays).print(output);
  }

  static std::string chart(const LoadedScene& scene, const std::vector<Contender>& contenders,
                           const MeasuredRays& rays) {
    std::vector<ChartPanel> panels;
    ChartPanel builds{"Build time in ms (shorter is better)", {}};
    for (const Contender& c : contenders) {
      const double ms = median(c.build_ms);
      builds.bars.push_back({c.name, ms, fmt::format("{:.1f} ms", ms)});
    }
    panels.push_back(builds);
    for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
      ChartPanel panel{
          fmt::format("Millions of {} rays a second (longer is better)", to_string(kRayKinds[k])),
          {}};
      for (const Contender& c : contenders) {
        const double rate = mrays_per_s(rays.rays[k].size(), median(c.trace_ms[k]));
        panel.bars.push_back({c.name, rate, fmt::format("{:.2f}", rate)});
      }
      panels.push_back(panel);
    }
    return bar_chart_svg(
        fmt::format("{}, {} triangles", scene.mesh.name, with_commas(scene.view.triangle_count)),
        panels);
  }

  ordered_json json(const Context& context, const LoadedScene& scene,
                    const std::vector<Contender>& contenders, const MeasuredRays& rays,
                    const render::Camera& camera, const std::string& wrong) const {
    ordered_json list = ordered_json::array();
    for (const Contender& c : contenders) {
      ordered_json entry = {
          {"builder", c.name}, {"build_ms", median(c.build_ms)}, {"build_ms_all", c.build_ms}};
      if (!c.is_embree()) {
        entry["depth"] = c.tree.info().depth;
        entry["tree_hash"] = hash_string(c.tree.hash());
        entry["quality"] = app::json_of(c.quality);
      }
      for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
        const std::size_t n = rays.rays[k].size();
        const double ms = median(c.trace_ms[k]);
        ordered_json kind = {{"rays", n},
                             {"trace_ms", ms},
                             {"trace_ms_all", c.trace_ms[k]},
                             {"mrays_per_s", mrays_per_s(n, ms)}};
        if (!c.is_embree()) {
          const double count = static_cast<double>(std::max<std::size_t>(1, n));
          kind["inner_steps_per_ray"] = static_cast<double>(c.counters[k].inner_steps) / count;
          kind["leaf_visits_per_ray"] = static_cast<double>(c.counters[k].leaf_visits) / count;
          kind["triangle_tests_per_ray"] =
              static_cast<double>(c.counters[k].triangle_tests) / count;
        }
        entry[to_string(kRayKinds[k])] = kind;
      }
      list.push_back(entry);
    }
    ordered_json json = json_of_program();
    json["scene"] = scene.mesh.name;
    json["source"] = scene_;
    json["triangles"] = scene.view.triangle_count;
    json["threads"] = context.threads;
    json["rounds"] = rounds_;
    json["camera"] = app::json_of(camera);
    json["same_hits"] = wrong.empty();
    json["builders"] = list;
    return json;
  }

  std::string scene_;
  std::string builders_;
  std::uint32_t rounds_ = 5;
  std::uint32_t width_ = 512;
  std::uint32_t height_ = 512;
  int depth_ = kAutoDepth;
  CameraOptions camera_;
  std::uint64_t memory_limit_ = 0;
  std::string csv_;
  std::string svg_;
};

}  // namespace

std::unique_ptr<Command> make_compare_command() {
  return std::make_unique<CompareCommand>();
}

}  // namespace fasttree::app
