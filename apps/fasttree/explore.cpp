// SPDX-License-Identifier: Apache-2.0
// fasttree explore: many configurations of a machine over scenes, and which of them are worth it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "command.h"
#include "design_points.h"
#include "effects.h"
#include "exploration.h"
#include "model/report/area.h"
#include "model/report/energy.h"
#include "options.h"
#include "output.h"
#include "pareto.h"
#include "progress.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;

std::vector<Costs> costs_of(const std::vector<Summary*>& list, double Summary::*x) {
  std::vector<Costs> costs;
  for (const Summary* s : list) costs.push_back({s->*x, s->time_ms});
  return costs;
}

ordered_json run_json(const ExploredRun& run) {
  ordered_json json = {{"scene", run.scene}, {"status", run.status}, {"triangles", run.triangles}};
  if (run.done()) {
    json["cycles"] = run.cycles;
    json["time_ms"] = run.time_ms;
    json["cycles_per_triangle"] = run.cycles_per_triangle;
    json["bandwidth_gb_s"] = run.bandwidth_gb_s;
    json["machine_uj"] = run.machine_uj;
    json["memory_uj"] = run.memory_uj;
    json["energy_uj"] = run.energy_uj;
    json["machine_power_w"] = run.machine_power_w;
    json["tree_hash"] = run.tree_hash;
  }
  json["key"] = run.key;
  return json;
}

class ExploreCommand : public Command {
 public:
  const char* name() const override { return "explore"; }
  const char* summary() const override { return "Many configurations of a machine over scenes"; }
  const char* details() const override {
    return "Simulates a machine with its keys changed: every combination of the --vary values, "
           "the\n"
           "points of a --list (CSV with keys as header, or TOML with [[point]] tables), or with\n"
           "--sensitivity one change at a time. One simulation a core. With --out FOLDER each\n"
           "result is kept in results.csv at once; the same command goes on where it was stopped.\n"
           "Figures over several scenes are geometric means. A point is on the front where no\n"
           "other is as good by both measures and better by one.\n\n"
           "Example:\n"
           "  fasttree explore --config paper-asic65 --scene scene:knot:5k \\\n"
           "    --vary paper.bus_bytes_per_cycle=8,16,32 --vary paper.prefix_sum_units=2,4,8 \\\n"
           "    --out bus\n"
           "  fasttree explore --config paper-asic65 --scene bunny.ply --sensitivity";
  }

  void declare(Options& options) override {
    options.text(config_, "--config", "NAME|FILE", "The machine to start from");
    options.texts(set_, "--set", "KEY=VALUE", "Change a key of it; may be repeated");
    options.texts(scenes_, "--scene", "SCENE", "A scene to build; may be repeated");
    options.texts(vary_, "--vary", "KEY=V,V,...", "Values of a key; may be repeated");
    options.text(list_, "--list", "FILE", "Points, as CSV or TOML, instead of --vary");
    options.flag(sensitivity_, "--sensitivity",
                 "One change at a time: of --vary, or of every assumption of the machine");
    options.text(out_, "--out", "FOLDER",
                 "Keep results.csv, explore.json, pareto.svg (and sensitivity.csv); resumable");
    options.size(memory_bytes_, "--memory-limit", "Memory the simulations may take, such as 2G",
                 "4/5 of the machine's");
  }

  int run(Context& context) override {
    check_usage();
    model::MachineConfig base = take(model::load_config(config_));
    for (const std::string& change : set_) check(model::apply_override(base, change));
    const std::vector<DesignPoint> points = design_points(base);
    const std::vector<ExploredScene> scenes = load_scenes(context, scenes_);
    if (!out_.empty()) {
      std::error_code error;
      std::filesystem::create_directories(out_, error);
      if (error) throw Failure{kBadInput, fmt::format("{}: {}", out_, error.message())};
    }
    ResultsFile file(in_folder("results.csv"));
    const std::uint64_t bytes = memory_bytes_ > 0 ? memory_bytes_ : most_of_memory();
    const Exploration made = explore(context, points, scenes, file, bytes);
    context.progress.clear();
    if (made.cancelled) {
      throw Failure{kCancelled,
                    fmt::format("cancelled after {} of {} runs{}", made.runs.size(),
                                points.size() * scenes.size(),
                                out_.empty() ? "" : "; the same command goes on from there")};
    }
    std::vector<Summary> list = summaries(points, scenes.size(), made.runs);
    const std::string svg = find_fronts(list);
    const std::vector<Effect> effects = sensitivity_ ? effects_of(list) : std::vector<Effect>{};
    print(context.output, list, effects, made);
    const ordered_json json = json_of_all(base, list, effects, made);
    if (!out_.empty()) {
      context.output.json(json, in_folder("explore.json"));
      context.output.file(svg, in_folder("pareto.svg"));
      if (sensitivity_) context.output.file(table_of(effects).csv(), in_folder("sensitivity.csv"));
      context.output.line("");
      context.output.line("kept in {}", out_);
    }
    context.output.json(json, context.common.json);
    return kDone;
  }

 private:
  void check_usage() const {
    if (scenes_.empty()) throw Failure{kUsage, "explore needs a --scene, such as scene:knot:5k"};
    if (!list_.empty() && (!vary_.empty() || sensitivity_)) {
      throw Failure{kUsage, "--list names its points: not with --vary or --sensitivity"};
    }
    if (list_.empty() && vary_.empty() && !sensitivity_) {
      throw Failure{kUsage, "explore needs --vary KEY=V,V,..., --list FILE or --sensitivity"};
    }
  }

  std::vector<DesignPoint> design_points(const model::MachineConfig& base) const {
    if (!list_.empty()) return listed_points(base, list_);
    const std::vector<Variation> variations = parse_variations(vary_);
    if (!sensitivity_) return grid_points(base, variations);
    return single_points(base, variations.empty() ? assumptions(base) : variations);
  }

  std::string in_folder(const char* name) const {
    return out_.empty() ? "" : (std::filesystem::path(out_) / name).string();
  }

  /// Marks the points of both fronts, and draws them.
  std::string find_fronts(std::vector<Summary>& list) const {
    std::vector<Summary*> done;
    std::vector<std::string> labels;
    for (Summary& s : list) {
      if (!s.done) continue;
      done.push_back(&s);
      labels.push_back(s.point->label);
    }
    const std::vector<Costs> area = costs_of(done, &Summary::area_mm2);
    const std::vector<Costs> energy = costs_of(done, &Summary::energy_uj);
    const std::vector<bool> front_area = pareto_front(area), front_energy = pareto_front(energy);
    for (std::size_t i = 0; i < done.size(); ++i) {
      done[i]->front_area = front_area[i];
      done[i]->front_energy = front_energy[i];
    }
    const std::string y = scenes_.size() > 1 ? "time, ms (mean over scenes)" : "time, ms";
    return pareto_svg(fmt::format("{} over {}", config_, fmt::join(scenes_, ", ")), labels,
                      {{"Time against area", "area at 65 nm, mm2 (estimate)", y, area},
                       {"Time against energy", "energy of a build, uJ (estimate)", y, energy}});
  }

  Table table_of(const std::vector<Effect>& effects) const {
    std::vector<std::string> header = {"change"};
    for (const std::string& scene : scenes_) header.push_back("time % " + scene);
    if (scenes_.size() > 1) header.push_back("time % mean");
    header.insert(header.end(), {"area %", "energy %"});
    Table table(header);
    for (const Effect& effect : effects) {
      std::vector<std::string> row = {effect.changed->point->label};
      for (const double p : effect.time_percent) row.push_back(fmt::format("{:+.2f}", p));
      if (scenes_.size() > 1) row.push_back(fmt::format("{:+.2f}", effect.mean_time_percent));
      row.push_back(fmt::format("{:+.2f}", effect.area_percent));
      row.push_back(fmt::format("{:+.2f}", effect.energy_percent));
      table.row(std::move(row));
    }
    return table;
  }

  void print(Output& output, const std::vector<Summary>& list, const std::vector<Effect>& effects,
             const Exploration& made) const {
    output.line("machine              {}", config_);
    output.line("scenes               {}", fmt::join(scenes_, ", "));
    output.line("runs                 {} ({} from an earlier run)", made.runs.size(), made.resumed);
    output.line("");
    if (sensitivity_) {
      const Summary& base = list.front();
      if (base.done) {
        output.line("base: {:.4f} ms, {:.2f} cycles a triangle, {:.3f} mm2, {:.1f} uJ",
                    base.time_ms, base.cycles_per_triangle, base.area_mm2, base.energy_uj);
        output.line("What one change is worth:");
        table_of(effects).print(output);
      }
    } else {
      Table table({"point", "time ms", "cycles/triangle", "mm2 at 65 nm", "energy uJ", "front"});
      for (const Summary& s : list) {
        if (!s.done) continue;
        table.row(
            {s.point->label, fmt::format("{:.4f}", s.time_ms),
             fmt::format("{:.2f}", s.cycles_per_triangle), fmt::format("{:.3f}", s.area_mm2),
             fmt::format("{:.1f}", s.energy_uj),
             fmt::format("{}{}", s.front_area ? "area " : "", s.front_energy ? "energy" : "")});
      }
      table.print(output);
    }
    for (const Summary& s : list) {
      for (const ExploredRun* run : s.runs) {
        if (!run->done()) output.line("{} on {}: {}", run->point, run->scene, run->status);
      }
    }
    output.line("");
    output.line("area: {}", model::area_basis());
    output.line("energy: {}", model::energy_basis());
  }

  ordered_json json_of_all(const model::MachineConfig& base, const std::vector<Summary>& list,
                           const std::vector<Effect>& effects, const Exploration& made) const {
    ordered_json json = json_of_program();
    json["config"] = base.name;
    json["set"] = set_;
    json["scenes"] = scenes_;
    json["runs"] = made.runs.size();
    json["resumed_runs"] = made.resumed;
    json["area_basis"] = model::area_basis();
    json["energy_basis"] = model::energy_basis();
    json["points"] = ordered_json::array();
    for (const Summary& s : list) {
      ordered_json point = {{"point", s.point->label}, {"changes", s.point->changes}};
      if (s.done) {
        point["time_ms"] = s.time_ms;
        point["cycles_per_triangle"] = s.cycles_per_triangle;
        point["area_65nm_mm2"] = s.area_mm2;
        point["energy_uj"] = s.energy_uj;
      }
      point["front_time_area"] = s.front_area;
      point["front_time_energy"] = s.front_energy;
      point["runs"] = ordered_json::array();
      for (const ExploredRun* run : s.runs) point["runs"].push_back(run_json(*run));
      json["points"].push_back(std::move(point));
    }
    if (sensitivity_) {
      json["sensitivity"] = ordered_json::array();
      for (const Effect& effect : effects) {
        json["sensitivity"].push_back({{"change", effect.changed->point->changes.front()},
                                       {"time_percent", effect.mean_time_percent},
                                       {"time_percent_by_scene", effect.time_percent},
                                       {"area_percent", effect.area_percent},
                                       {"energy_percent", effect.energy_percent}});
      }
    }
    return json;
  }

  std::string config_ = "paper-asic65";
  std::vector<std::string> set_, scenes_, vary_;
  std::string list_, out_;
  bool sensitivity_ = false;
  std::uint64_t memory_bytes_ = 0;
};

}  // namespace

std::unique_ptr<Command> make_explore_command() {
  return std::make_unique<ExploreCommand>();
}

}  // namespace fasttree::app
