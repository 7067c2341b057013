// SPDX-License-Identifier: Apache-2.0
// fasttree compare: the builders against each other and against Embree, on the same scene and the
// same rays.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "compare_report.h"
#include "contender.h"
#include "figures.h"
#include "inputs.h"
#include "measure.h"
#include "options.h"
#include "oracle/embree_oracle.h"
#include "output.h"
#include "progress.h"
#include "vertex_buffers.h"
#include "views.h"

namespace fasttree::app {
namespace {

bool same_bits(const Hit& a, const Hit& b) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return a.triangle == b.triangle && bits(a.t) == bits(b.t) && bits(a.u) == bits(b.u) &&
         bits(a.v) == bits(b.v);
}

/// Holds everybody's results against those of the first tree's single rays.
class Judge {
 public:
  /// Results to write into, as long as the rays. They hold what nobody finds, so that a result left
  /// out does not pass for the one before it.
  Traced& clean_results(RayKind kind, std::size_t count) {
    constexpr Hit kNobodys{-1.0f, kNoTriangle - 1, -1.0f, -1.0f};
    if (kind == RayKind::shadow) {
      latest_.flags.assign(count, 0xff);
    } else {
      latest_.hits.assign(count, kNobodys);
    }
    return latest_;
  }

  /// The latest results become the expected ones.
  void expect_latest(RayKind kind) { expected(kind) = latest_; }

  bool latest_is_expected(RayKind kind) const {
    if (kind == RayKind::shadow) return latest_.flags == expected(kind).flags;
    const Measured<Hit>& hits = expected(kind).hits;
    return std::equal(latest_.hits.begin(), latest_.hits.end(), hits.begin(), hits.end(),
                      same_bits);
  }

  /// Rays that hit where the expected ones miss, or the reverse: all that can be said of somebody
  /// who rounds in another way.
  std::uint64_t other_outcomes(RayKind kind) const {
    const Traced& e = expected(kind);
    std::uint64_t n = 0;
    if (kind == RayKind::shadow) {
      for (std::size_t i = 0; i < e.flags.size(); ++i) n += latest_.flags[i] != e.flags[i] ? 1 : 0;
    } else {
      for (std::size_t i = 0; i < e.hits.size(); ++i) {
        n += latest_.hits[i].hit() != e.hits[i].hit() ? 1 : 0;
      }
    }
    return n;
  }

 private:
  Traced& expected(RayKind kind) { return expected_[static_cast<std::size_t>(kind)]; }
  const Traced& expected(RayKind kind) const { return expected_[static_cast<std::size_t>(kind)]; }

  std::array<Traced, kRayKinds.size()> expected_;
  Traced latest_;
};

class CompareCommand : public Command {
 public:
  const char* name() const override { return "compare"; }
  const char* summary() const override {
    return "Measure the builders against each other and Embree";
  }
  const char* details() const override {
    return "Every round, each contender builds anew in the memory it has kept and traces the same\n"
           "primary, shadow and diffuse rays, as single rays and in packets. Figures are medians\n"
           "over the rounds; a first round warms up and does not count. All trees have to find "
           "the\n"
           "same hits each way, to the bit, or the exit is 1. A frame is the build and the "
           "primary\n"
           "and shadow rays, each the fastest way.\n"
           "Embree rebuilds a dynamic scene at build quality low and medium. The ratios are those\n"
           "of the first kd-tree over Embree: more than 1 where the tree is faster.\n"
           "Builders: realtime, paper-cyclic, paper-longest, sah-binned, sah-exact, embree-low,\n"
           "embree-medium; embree is both.\n\n"
           "Example:\n"
           "  fasttree compare bunny.ply --threads 2 --json bunny.json --svg bunny.svg\n"
           "  fasttree compare bunny.ply --profile sah-binned --view tight\n"
           "  fasttree compare sponza.ply --eye -11,4,0 --target 10,5,0 --light 0,10,0";
  }

  void declare(Options& options) override {
    memory_limit_ = most_of_memory();
    options.positional(scene_, "SCENE", "A mesh file, or scene:NAME");
    Choices<std::optional<Profile>> choices;
    for (const auto& [name, profile] : profiles()) choices.emplace_back(name, profile);
    options.choice(profile_, "--profile",
                   "Whose tree meets Embree; without it, realtime's beside the paper's", choices);
    options.text(builders_, "--builders", "LIST",
                 "Who takes part, such as realtime,sah-binned,embree");
    options.count(rounds_, "--repeat", "Rounds of building and tracing", 1, 10000);
    options.extent(rays_.width, rays_.height, "--size", "Primary rays", 4096);
    options.depth(depth_, "--depth", "Levels of the grid (profile paper)", 30);
    camera_.declare(options);
    options.point(rays_.light, "--light", "The point light; without it, beside the camera");
    options.size(memory_limit_, "--memory-limit",
                 "Memory a build may take, such as 512M; 0: no limit", bytes_text(memory_limit_));
    options.text(csv_, "--csv", "FILE", "Write the table as CSV");
    options.text(svg_, "--svg", "FILE", "Draw the figures as a bar chart");
  }

  int run(Context& context) override {
    Contenders contenders = choose_contenders();
    Comparison comparison;
    if (!oracle::embree_available()) {
      comparison.no_embree = "this program was built without Embree";
    } else if (contenders.back()->is_tree()) {
      comparison.no_embree = "Embree is not among the builders";
    }
    const LoadedScene scene = load_scene(context, scene_, memory_limit_);
    comparison.scene = scene.mesh.name;
    comparison.source = scene_;
    comparison.triangles = scene.view.triangle_count;
    comparison.threads = context.threads;
    comparison.rounds = rounds_;
    comparison.width = rays_.width;
    comparison.height = rays_.height;

    const VertexBuffers buffers(scene.view);
    const MeasuredRays rays =
        make_rays(static_cast<TreeContender&>(*contenders[0]), buffers.view(), comparison);
    drop_embree_where_it_cannot(contenders, rays, bounds_, comparison);
    comparison.wrong = measure(context, contenders, buffers.view(), rays);
    context.progress.clear();

    std::vector<Figures> embrees;
    for (const auto& c : contenders) {
      comparison.figures.push_back(figures_of(c->record, comparison.counts));
      if (!c->is_tree()) embrees.push_back(comparison.figures.back());
      comparison.records.push_back(std::move(c->record));
    }
    comparison.duel = head_to_head(comparison.figures[0], embrees);
    report(context, comparison);
    if (!comparison.wrong.empty()) {
      std::fputs(fmt::format("fasttree: error: {}\n", comparison.wrong).c_str(), stderr);
      return kCheckFailed;
    }
    return kDone;
  }

 private:
  using Contenders = std::vector<std::unique_ptr<Contender>>;

  Contenders choose_contenders() const {
    if (profile_ && !builders_.empty()) {
      throw Failure{
          kUsage,
          "give --profile or --builders, not both: the first kd-tree of --builders is the "
          "one that meets Embree"};
    }
    BuildSettings settings;
    settings.memory_limit_bytes = memory_limit_;
    settings.progress = [](const char*, double) { return !cancelled(); };
    return make_contenders(
        builders_.empty() ? default_contenders(profile_) : parse_contenders(builders_), settings,
        depth_);
  }

  /// The rays start where the first contender's tree says that something is.
  MeasuredRays make_rays(TreeContender& first, const MeshView& mesh, Comparison& comparison) {
    first.build(mesh);
    bounds_ = first.tree().info().bounds;
    comparison.camera = camera_.choose(scene_, bounds_, first.tracer(), render::View::outside);
    MeasuredRays rays = make_measured_rays(comparison.camera, rays_, mesh, bounds_, first.tracer());
    comparison.light = rays.light;
    comparison.counts = count_of(rays);
    return rays;
  }

  /// Embree, which comes last, misses everything where coordinates are too large for it.
  static void drop_embree_where_it_cannot(Contenders& contenders, const MeasuredRays& rays,
                                          const Box3& bounds, Comparison& comparison) {
    if (contenders.back()->is_tree()) return;
    // A ray from one corner to the other has the scene's own largest coordinates.
    Ray diagonal;
    diagonal.origin = bounds.lo;
    diagonal.direction = bounds.hi;
    bool accepted = oracle::EmbreeScene::accepts(diagonal);
    for (const auto& kind : rays.rays) {
      accepted = accepted && std::all_of(kind.begin(), kind.end(), oracle::EmbreeScene::accepts);
    }
    if (accepted) return;
    std::erase_if(contenders, [](const auto& c) { return !c->is_tree(); });
    comparison.no_embree = "Embree does not take coordinates as large as this scene's";
  }

  /// All rounds. Says which tree finds other hits than the first one's single rays, if one does.
  std::string measure(Context& context, Contenders& contenders, const MeshView& mesh,
                      const MeasuredRays& rays) const {
    ProgressCallback progress = context.progress.callback("comparing");
    const double steps = (rounds_ + 1.0) * static_cast<double>(contenders.size());
    double done = 0;
    Judge judge;
    std::string wrong;
    for (std::uint32_t round = 0; round <= rounds_; ++round) {
      const bool counts = round > 0;
      for (const auto& c : contenders) {
        if (!progress(c->record.name.c_str(), done++ / steps)) stop_if_cancelled();
        const double build_ms = c->build(mesh);
        if (counts) c->record.build_ms.push_back(build_ms);
        if (auto* tree = dynamic_cast<TreeContender*>(c.get())) {
          if (counts) tree->record.tree->layout_ms.push_back(tree->layout_ms());
          if (!counts) tree->study(rays);
        }
        const std::string difference = trace(*c, rays, judge, counts, c == contenders[0]);
        if (wrong.empty()) wrong = difference;
      }
    }
    return wrong;
  }

  static std::string trace(Contender& c, const MeasuredRays& rays, Judge& judge, bool counts,
                           bool first) {
    std::string wrong;
    for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
      const RayKind kind = kRayKinds[k];
      for (std::size_t way = 0; way < c.record.ways.size(); ++way) {
        stop_if_cancelled();
        Traced& traced = judge.clean_results(kind, rays.of(kind).size());
        const double ms = c.trace(kind, way, rays.of(kind), traced);
        if (counts) c.record.trace_ms[k][way].push_back(ms);
        if (!counts && first && way == 0) judge.expect_latest(kind);
        if (c.is_tree() && !judge.latest_is_expected(kind)) {
          wrong = fmt::format(
              "the tree of {} finds other hits for {} rays ({}) than the first tree's single rays; "
              "run fasttree verify to see which is wrong",
              c.record.name, to_string(kind), c.record.ways[way]);
        } else if (!c.is_tree() && !counts) {
          c.read(kind, traced);
          c.record.other_outcomes[k] =
              std::max(c.record.other_outcomes[k], judge.other_outcomes(kind));
        }
      }
    }
    return wrong;
  }

  void report(Context& context, const Comparison& comparison) const {
    print(context.output, comparison);
    if (!csv_.empty()) context.output.file(csv_of(comparison), csv_);
    if (!svg_.empty()) context.output.file(svg_of(comparison), svg_);
    context.output.json(json_of(comparison), context.common.json);
  }

  std::string scene_;
  std::optional<Profile> profile_;
  std::string builders_;
  std::uint32_t rounds_ = 9;
  RaySettings rays_{1024, 1024, std::nullopt};
  int depth_ = kAutoDepth;
  CameraOptions camera_;
  Box3 bounds_;
  std::uint64_t memory_limit_ = 0;
  std::string csv_;
  std::string svg_;
};

}  // namespace

std::unique_ptr<Command> make_compare_command() {
  return std::make_unique<CompareCommand>();
}

}  // namespace fasttree::app
