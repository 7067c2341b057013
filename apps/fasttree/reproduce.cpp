// SPDX-License-Identifier: Apache-2.0
// fasttree reproduce: the paper's Tables I, II and III beside our figures, or all of its
// evaluation.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "command.h"
#include "exploration.h"
#include "fasttree/build.h"
#include "model/report/area.h"
#include "model/report/energy.h"
#include "options.h"
#include "output.h"
#include "paper_tables.h"
#include "progress.h"
#include "reproduce_all.h"
#include "reproduction.h"
#include "table1.h"

namespace fasttree::app {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Mesh files of a folder, the paper's scenes first and in its order.
std::vector<std::string> mesh_files(const std::string& folder) {
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) throw Failure{kBadInput, fmt::format("{}: {}", folder, error.message())};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : entries) {
    const std::string extension = entry.path().extension().string();
    const auto known = {".ply", ".obj", ".stl", ".glb", ".gltf"};
    if (std::find(known.begin(), known.end(), extension) != known.end()) {
      files.push_back(entry.path());
    }
  }
  const auto place = [](const fs::path& file) {
    const auto table = paper_table2();
    const auto found = std::find_if(table.begin(), table.end(),
                                    [&](const PaperBuild& row) { return file.stem() == row.file; });
    return std::pair(found - table.begin(), file.string());
  };
  std::sort(files.begin(), files.end(),
            [&](const fs::path& a, const fs::path& b) { return place(a) < place(b); });
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.string());
  return names;
}

class ReproduceCommand : public Command {
 public:
  const char* name() const override { return "reproduce"; }
  const char* summary() const override {
    return "The paper's tables, or all of its evaluation, beside ours";
  }
  const char* details() const override {
    return "table1: what synthesis makes of each unit of the RTL, beside the paper's prototype.\n"
           "table2: build times of the paper's machine, simulated: the FPGA prototype, the ASIC "
           "as\n"
           "the paper has it (the prototype's cycles at 500 MHz), and the ASIC against the timing\n"
           "of its own memory. table3: the paper's comparison, with the simulated machines and\n"
           "this library, measured here. A scene of the paper is known by its file's name\n"
           "(bunny, sibenik, fairy_forest, conference, dragon, happy_buddha) and its count of\n"
           "triangles, within 1 %; any other goes under its own name without a paper's value.\n"
           "all: all tables, Figures 1 and 5, our own machine, and what each assumption is worth, "
           "as\n"
           "one page that needs nothing else, with the figures as JSON and CSV beside it. Without\n"
           "scenes built-in ones stand in.\n\n"
           "Example:\n  fasttree reproduce all --scenes meshes --out report\n"
           "  fasttree reproduce all --quick\n  fasttree reproduce table1\n"
           "  fasttree reproduce table2 --scenes meshes --csv table2.csv\n"
           "  fasttree reproduce table3 --scene bunny.ply --repeat 9";
  }

  void declare(Options& options) override {
    options.positional(table_, "TABLE", "table1, table2, table3 or all");
    options.text(folder_, "--scenes", "FOLDER", "All meshes of a folder");
    options.texts(scenes_, "--scene", "SCENE", "A scene; may be repeated");
    options.count(repeat_, "--repeat", "Builds of the library, for a median (table3, all)", 1,
                  1000);
    options.number(within_, "--within", "Fail (1) where a ratio is further from 1, in %", 0, 1000);
    options.text(csv_, "--csv", "FILE", "Write the table as CSV");
    options.text(out_, "--out", "FOLDER", "Where the page goes, and its figures beside it (all)");
    options.flag(quick_, "--quick", "Small pictures, built-in scenes and one measured frame (all)");
    options.size(memory_bytes_, "--memory-limit", "Memory the simulations may take, such as 2G",
                 "4/5 of the machine's");
  }

  int run(Context& context) override {
    check_usage();
    if (table_ == "table1") return report_table1(context, csv_);
    if (table_ == "all") return whole(context);
    if (folder_.empty() && scenes_.empty()) {
      throw Failure{kUsage, "reproduce needs scenes: --scenes FOLDER or --scene SCENE"};
    }
    const std::vector<ExploredScene> scenes = load_scenes(context, scene_names());
    const std::vector<DesignPoint> points = machines();
    ResultsFile nowhere("");
    const Exploration made = explore(context, points, scenes, nowhere, memory_limit());
    context.progress.clear();
    if (made.cancelled) throw Failure{kCancelled, "cancelled"};
    for (const ExploredRun& run : made.runs) {
      if (!run.done()) {
        throw Failure{kResourceLimit,
                      fmt::format("{} on {}: {}", run.config, run.scene, run.status)};
      }
    }
    std::vector<Compared> rows;
    std::vector<std::string> found;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      const PaperBuild* paper = paper_of(scenes[i]);
      if (paper != nullptr) found.emplace_back(paper->file);
      const std::string name = paper != nullptr ? paper->scene : scenes[i].scene.mesh.name;
      std::vector<const ExploredRun*> runs;
      for (std::size_t p = 0; p < points.size(); ++p) {
        runs.push_back(&made.runs[p * scenes.size() + i]);
      }
      const auto more = table_ == "table2"
                            ? reproduce_table2(name, paper, *runs[0], *runs[1])
                            : reproduce_table3(name, paper, runs, library(context, scenes[i]));
      rows.insert(rows.end(), more.begin(), more.end());
    }
    return report(context, rows, found);
  }

 private:
  void check_usage() const {
    const std::vector<std::string> tables = {"table1", "table2", "table3", "all"};
    if (std::find(tables.begin(), tables.end(), table_) == tables.end()) {
      const std::string near = nearest(table_, tables);
      throw Failure{
          kUsage, fmt::format("there is no table '{}'; give table1, table2, table3 or all{}",
                              table_, near.empty() ? "" : fmt::format("; did you mean {}?", near))};
    }
    if (table_ == "table1" && (!folder_.empty() || !scenes_.empty() || within_)) {
      throw Failure{kUsage,
                    "table1 is of the RTL, without scenes or a time: --scenes, --scene "
                    "and --within are for table2, table3 and all"};
    }
    if (table_ == "all" && !csv_.empty()) {
      throw Failure{kUsage, "--csv is for one table; all writes its tables into the --out folder"};
    }
    if (table_ != "all" && (quick_ || !out_.empty())) {
      throw Failure{kUsage, fmt::format("--out and --quick are for all, not for {}", table_)};
    }
  }

  int whole(Context& context) const {
    EvaluationSettings settings;
    settings.scenes = scene_names();
    settings.quick = quick_;
    settings.repeat = repeat_;
    settings.memory_bytes = memory_limit();
    return reproduce_all(context, settings, out_.empty() ? "report" : out_, within_);
  }

  /// Of the folder, then those given one by one.
  std::vector<std::string> scene_names() const {
    std::vector<std::string> names =
        folder_.empty() ? std::vector<std::string>{} : mesh_files(folder_);
    names.insert(names.end(), scenes_.begin(), scenes_.end());
    if (!folder_.empty() && names.empty()) throw Failure{kBadInput, folder_ + ": has no meshes"};
    return names;
  }

  std::uint64_t memory_limit() const {
    return memory_bytes_ > 0 ? memory_bytes_ : most_of_memory();
  }

  std::vector<DesignPoint> machines() const {
    std::vector<DesignPoint> points;
    const auto names = table_ == "table2"
                           ? std::vector<std::string>{"paper-fpga", "paper-asic65"}
                           : std::vector<std::string>{"paper-asic65", "paper-asic28", "fasttree-2"};
    for (const std::string& config : names) {
      points.push_back({config, {}, take(model::load_config(config))});
    }
    return points;
  }

  /// Of each profile that a hardware engine is an answer to: the paper's and the fastest.
  std::vector<LibraryTime> library(Context& context, const ExploredScene& scene) const {
    std::vector<LibraryTime> times;
    for (const Profile profile : {Profile::paper, Profile::realtime}) {
      BuildSettings settings;
      settings.profile = profile;
      settings.progress = context.progress.callback("measuring");
      Builder builder;
      Tree tree;
      std::vector<double> ms;
      // The first one warms up and does not count.
      for (std::uint32_t i = 0; i <= repeat_; ++i) {
        check(builder.build(scene.scene.view, settings, tree));
        if (i > 0) ms.push_back(builder.stats().build_ms);
      }
      times.push_back({to_string(profile), context.threads, median(ms)});
    }
    return times;
  }

  int report(Context& context, const std::vector<Compared>& rows,
             const std::vector<std::string>& found) const {
    Output& output = context.output;
    const bool costs = table_ == "table3";
    std::vector<std::string> skipped;
    for (const PaperBuild& row : paper_table2()) {
      if (costs && std::string(row.file) != "bunny") continue;
      if (std::find(found.begin(), found.end(), row.file) == found.end()) {
        skipped.push_back(row.file);
      }
    }
    output.line("{}", costs
                          ? "Table III: kd-tree construction, ours beside others"
                          : "Table II: kd-tree build time of the paper's machine, ours beside its");
    output.line("");
    if (costs) {
      paper_table3_table().print(output);
      output.line("");
    }
    table_of(rows, costs, false).print(output);
    output.line("");
    for (const Compared& row : rows) {
      output.line("{}, {}: {}", row.scene, row.figure, row.reason);
    }
    for (const std::string& file : skipped) {
      output.line("skipped: {}, which is not here (or of another size)", file);
    }
    output.line("");
    if (costs) {
      output.line("this machine: {}", processor_name());
      output.line("area: {}", model::area_basis());
      output.line("power: {}", model::energy_basis());
    }
    output.line("A ratio is our time over the paper's, a triangle.");
    if (!csv_.empty()) output.file(table_of(rows, costs, true).csv(), csv_);
    const double worst = worst_percent(rows);
    output.json(json(rows, skipped, worst), context.common.json);
    if (within_ && worst > *within_) {
      throw Failure{kCheckFailed,
                    fmt::format("a ratio is {:.1f} % from 1, more than {} %", worst, *within_)};
    }
    return kDone;
  }

  ordered_json json(const std::vector<Compared>& rows, const std::vector<std::string>& skipped,
                    double worst) const {
    ordered_json json = json_of_program();
    json["table"] = table_;
    json["rows"] = ordered_json::array();
    for (const Compared& row : rows) json["rows"].push_back(app::json_of(row));
    json["skipped"] = skipped;
    json["worst_percent"] = worst;
    if (table_ == "table3") {
      json["processor"] = processor_name();
      json["paper"] = ordered_json::array();
      for (const PaperPlatform& p : paper_table3()) json["paper"].push_back(app::json_of(p));
    }
    return json;
  }

  std::string table_, folder_, csv_, out_;
  std::vector<std::string> scenes_;
  std::uint32_t repeat_ = 5;
  std::optional<double> within_;
  bool quick_ = false;
  std::uint64_t memory_bytes_ = 0;
};

}  // namespace

std::unique_ptr<Command> make_reproduce_command() {
  return std::make_unique<ReproduceCommand>();
}

}  // namespace fasttree::app
