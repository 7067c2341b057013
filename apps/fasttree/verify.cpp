// SPDX-License-Identifier: Apache-2.0
// fasttree verify: is this tree right? Invariants, bytes against the reference, rays against an
// oracle.
#include "fasttree/verify.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "devices.h"
#include "fasttree/build.h"
#include "fasttree/tree_file.h"
#include "inputs.h"
#include "options.h"
#include "oracle/embree_oracle.h"
#include "oracle/ray_judge.h"
#include "output.h"
#include "progress.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

enum class OracleChoice { automatic, brute, embree };

/// Ray-triangle tests that brute force may take before `auto` looks for another oracle: half a
/// minute on two processors.
constexpr double kBruteForceTests = 2e10;

class VerifyCommand : public Command {
 public:
  const char* name() const override { return "verify"; }
  const char* summary() const override { return "Prove a tree right; exit 1 where it is not"; }
  const char* details() const override {
    return "Builds the scene's tree, or loads a tree file (--mesh names its scene), and checks\n"
           "  - every invariant of the tree, and that tree and mesh belong together;\n"
           "  - for profiles realtime and paper, that the fast and the reference builder, with "
           "and\n"
           "    without SIMD, on one thread and on all, make these same bytes;\n"
           "  - that rays find what the oracle finds: to the bit against brute force; against\n"
           "    Embree within rounding, and to the bit against brute force where the two differ.\n"
           "    More than half of the rays are made to meet planes, edges, vertices and corners\n"
           "    exactly. Oracle auto is brute force where that takes half a minute or so.\n\n"
           "Example:\n"
           "  fasttree verify bunny.ply --rays 100000\n"
           "  fasttree verify bunny.ft --mesh bunny.ply\n"
           "  fasttree verify bunny.ply --device udp://127.0.0.1:18004";
  }

  void declare(Options& options) override {
    options.positional(input_, "SCENE|TREE", "A scene to build, or a tree file");
    options.text(mesh_, "--mesh", "SCENE", "The scene that the tree file was built for");
    build_.declare(options);
    device_.declare(options);
    options.count(rays_, "--rays", "Rays to trace, over all kinds of them; 0: none", 0,
                  1'000'000'000'000);
    options.choice(oracle_, "--oracle", "Who judges the rays",
                   Choices<OracleChoice>{{"auto", OracleChoice::automatic},
                                         {"brute", OracleChoice::brute},
                                         {"embree", OracleChoice::embree}});
    options.count(seed_, "--seed", "Another seed, other rays", 0, ~std::uint64_t{0});
  }

  int run(Context& context) override {
    if (oracle_ == OracleChoice::embree && !oracle::embree_available()) {
      throw Failure{kUsage,
                    "--oracle embree: this program was built without Embree; give --oracle brute, "
                    "or build the program where Embree 3 is installed"};
    }
    const bool from_file = is_tree_file(input_);
    if (!from_file && !mesh_.empty()) {
      throw Failure{kUsage, fmt::format("--mesh goes with a tree file, and '{}' is none", input_)};
    }
    if (from_file && device_.given()) {
      throw Failure{kUsage, fmt::format("--device goes with a scene, and '{}' is a tree", input_)};
    }
    json_ = json_of_program();
    json_["input"] = input_;
    std::optional<Tree> file;
    if (from_file) {
      auto loaded = load_tree(input_);
      check(loaded.status());
      file = std::move(loaded).value();
      if (mesh_.empty()) return verify_alone(context, *file);
    }
    const LoadedScene scene =
        load_scene(context, from_file ? mesh_ : input_, build_.settings.memory_limit_bytes);
    json_["triangles"] = scene.view.triangle_count;
    context.output.line("scene                {} ({} triangles)", scene.mesh.name,
                        with_commas(scene.view.triangle_count));

    Tree tree;
    if (file) {
      tree = std::move(*file);
      take_over(tree.info());
    } else if (device_.given()) {
      DeviceTree built = device_.build(context, scene.view, build_.settings);
      context.progress.clear();
      print_device(context.output, built);
      json_["device"] = app::json_of(built);
      tree = std::move(built.tree);
      take_over(tree.info());
    } else {
      tree = build(context, scene.view, build_.settings, "building");
    }
    json_["profile"] = to_string(tree.info().profile);
    json_["axes"] = tree.info().profile == Profile::paper
                        ? ordered_json(to_string(tree.info().axes))
                        : ordered_json(nullptr);
    json_["depth"] = tree.info().depth;
    json_["tree_hash"] = hash_string(tree.hash());
    context.output.line("tree                 {}, depth {}, {} nodes, hash {}",
                        describe(tree.info()), tree.info().depth, with_commas(tree.nodes().size()),
                        hash_string(tree.hash()));
    bool ok = check_invariants(context, verify(tree, scene.view), "with the mesh");
    // Links of a broken tree must not be followed.
    if (ok && has_reference(tree.info().profile)) ok = check_bytes(context, scene.view, tree);
    if (ok && rays_ > 0) ok = check_rays(context, scene.view, tree);
    return finish(context, ok);
  }

 private:
  static bool has_reference(Profile profile) {
    return profile == Profile::paper || profile == Profile::realtime;
  }

  static std::string describe(const TreeInfo& info) {
    return info.profile == Profile::paper
               ? fmt::format("{}, {} axes", to_string(info.profile), to_string(info.axes))
               : std::string(to_string(info.profile));
  }

  /// The tree file says how it was built.
  void take_over(const TreeInfo& info) {
    build_.settings.profile = info.profile;
    build_.settings.axes = info.axes;
    if (info.profile == Profile::paper) build_.settings.depth = info.depth;
  }

  Tree build(Context& context, const MeshView& mesh, BuildSettings settings,
             const std::string& what) const {
    settings.progress = context.progress.callback(what);
    Builder builder;
    Tree tree = take(builder.build(mesh, settings));
    context.progress.clear();
    return tree;
  }

  int verify_alone(Context& context, const Tree& tree) {
    const bool ok = check_invariants(context, verify(tree), "without a mesh");
    if (ok) {
      context.output.line("rays                 none: give --mesh SCENE to trace some");
      json_["tree_hash"] = hash_string(tree.hash());
    }
    return finish(context, ok);
  }

  int finish(Context& context, bool ok) {
    json_["ok"] = ok;
    context.output.line("{}", ok ? "right" : "WRONG");
    context.output.json(json_, context.common.json);
    return ok ? kDone : kCheckFailed;
  }

  bool check_invariants(Context& context, const Verification& verification, const char* how) {
    json_["invariants"] = {{"ok", verification.ok}, {"checks", verification.checks}};
    if (verification.ok) {
      context.output.line("invariants           hold, {} ({} checks)", how,
                          with_commas(verification.checks));
      return true;
    }
    json_["invariants"]["broken"] = verification.invariant;
    json_["invariants"]["detail"] = verification.detail;
    complain(context, fmt::format("the tree breaks the invariant '{}': {}", verification.invariant,
                                  verification.detail));
    return false;
  }

  bool check_bytes(Context& context, const MeshView& mesh, const Tree& tree) {
    struct Variant {
      const char* name;
      Implementation implementation;
      Simd simd;
      bool one_thread = false;
    };
    constexpr std::array variants = {
        Variant{"reference", Implementation::reference, Simd::scalar},
        Variant{"fast, scalar", Implementation::fast, Simd::scalar},
        Variant{"fast, widest SIMD", Implementation::fast, Simd::widest},
        Variant{"fast, one thread", Implementation::fast, Simd::widest, true}};
    ordered_json compared = ordered_json::array();
    bool ok = true;
    for (const Variant& variant : variants) {
      BuildSettings settings = build_.settings;
      settings.implementation = variant.implementation;
      settings.simd = variant.simd;
      oneapi::tbb::task_arena arena(variant.one_thread ? 1 : context.threads);
      const Tree other =
          arena.execute([&] { return build(context, mesh, settings, variant.name); });
      const std::string difference = first_difference(tree, other);
      compared.push_back({{"builder", variant.name}, {"same", difference.empty()}});
      if (!difference.empty()) {
        ok = false;
        complain(context, fmt::format("the tree of builder '{}' has other bytes: {}", variant.name,
                                      difference));
      }
    }
    json_["bytes"] = {{"ok", ok}, {"compared_with", compared}};
    if (ok) {
      context.output.line(
          "bytes                equal those of the reference builder, and of the fast one "
          "without SIMD, with it, and on one thread");
    }
    return ok;
  }

  static std::string first_difference(const Tree& a, const Tree& b) {
    if (a.info() != b.info()) return "its info differs";
    if (a.nodes().size() != b.nodes().size()) {
      return fmt::format("{} nodes instead of {}", b.nodes().size(), a.nodes().size());
    }
    if (a.ids().size() != b.ids().size()) {
      return fmt::format("{} references instead of {}", b.ids().size(), a.ids().size());
    }
    const auto node = std::mismatch(a.nodes().begin(), a.nodes().end(), b.nodes().begin());
    if (node.first != a.nodes().end()) {
      return fmt::format("node {} differs", node.first - a.nodes().begin());
    }
    const auto id = std::mismatch(a.ids().begin(), a.ids().end(), b.ids().begin());
    if (id.first != a.ids().end()) {
      return fmt::format("reference {} differs", id.first - a.ids().begin());
    }
    return "";
  }

  /// The oracle and how many rays it gets.
  std::pair<oracle::Oracle, std::uint64_t> choose_oracle(Context& context,
                                                         std::uint32_t triangles) const {
    if (oracle_ == OracleChoice::brute) return {oracle::Oracle::brute, rays_};
    if (oracle_ == OracleChoice::embree) return {oracle::Oracle::embree, rays_};
    const double tests = static_cast<double>(rays_) * triangles;
    if (tests <= kBruteForceTests) return {oracle::Oracle::brute, rays_};
    if (oracle::embree_available()) return {oracle::Oracle::embree, rays_};
    const auto fewer = std::max<std::uint64_t>(
        oracle::kAllRaySets.size(), static_cast<std::uint64_t>(kBruteForceTests / triangles));
    context.output.line(
        "rays                 only {} of the {} asked for: this program was built without Embree, "
        "and brute force would take long; --oracle brute traces them all",
        with_commas(fewer), with_commas(rays_));
    return {oracle::Oracle::brute, std::min(fewer, rays_)};
  }

  bool check_rays(Context& context, const MeshView& mesh, const Tree& tree) {
    const auto [oracle, rays] = choose_oracle(context, mesh.triangle_count);
    oracle::JudgeSettings settings;
    settings.oracle = oracle;
    settings.rays = rays;
    settings.seed = seed_;
    settings.progress = context.progress.callback("tracing");
    const Tracer tracer = make_tracer(tree, mesh);
    const auto start = std::chrono::steady_clock::now();
    const oracle::RayReport report = take(oracle::judge_rays(mesh, tree, tracer, settings));
    const double ms = milliseconds_since(start);
    context.progress.clear();
    print_rays(context, report, ms);
    json_rays(report, ms);
    if (!report.ok()) complain(context, report.first_wrong);
    return report.ok();
  }

  static void print_rays(Context& context, const oracle::RayReport& report, double ms) {
    Table table({"rays", "number", "hits", "all triangles tested", "Embree overruled", "wrong"});
    const auto row = [&](const std::string& name, const oracle::SetReport& set) {
      table.row({name, with_commas(set.rays), with_commas(set.hits), with_commas(set.brute_checked),
                 report.oracle == oracle::Oracle::embree ? with_commas(set.settled) : "-",
                 with_commas(set.wrong)});
    };
    for (const oracle::SetReport& set : report.sets) row(to_string(set.set), set);
    row("total", report.total());
    context.output.line("");
    table.print(context.output);
    context.output.line("oracle               {}, {:.1f} s",
                        report.oracle == oracle::Oracle::brute
                            ? std::string("brute force, to the bit")
                            : fmt::format("Embree {}", oracle::embree_version()),
                        ms / 1000);
  }

  void json_rays(const oracle::RayReport& report, double ms) {
    const auto json = [](const oracle::SetReport& set) {
      return ordered_json{{"rays", set.rays},
                          {"hits", set.hits},
                          {"brute_force_checked", set.brute_checked},
                          {"embree_overruled", set.settled},
                          {"wrong", set.wrong}};
    };
    ordered_json sets = ordered_json::object();
    for (const oracle::SetReport& set : report.sets) sets[to_string(set.set)] = json(set);
    json_["rays"] = json(report.total());
    json_["rays"]["requested"] = rays_;
    json_["rays"]["oracle"] = to_string(report.oracle);
    json_["rays"]["seed"] = seed_;
    json_["rays"]["rays_ms"] = ms;
    json_["rays"]["sets"] = sets;
    if (!report.ok()) json_["rays"]["first_wrong"] = report.first_wrong;
  }

  /// On standard error, like every error: the run goes on to write its figures.
  static void complain(Context& context, const std::string& message) {
    context.progress.clear();
    std::fputs(fmt::format("fasttree: error: {}\n", message).c_str(), stderr);
  }

  std::string input_;
  std::string mesh_;
  BuildOptions build_;
  DeviceOptions device_;
  std::uint64_t rays_ = 10'000;
  OracleChoice oracle_ = OracleChoice::automatic;
  std::uint64_t seed_ = 1;
  ordered_json json_;
};

}  // namespace

std::unique_ptr<Command> make_verify_command() {
  return std::make_unique<VerifyCommand>();
}

}  // namespace fasttree::app
