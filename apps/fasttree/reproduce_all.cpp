// SPDX-License-Identifier: Apache-2.0
#include "reproduce_all.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "output.h"
#include "report/json.h"
#include "report/sections.h"
#include "report/tables.h"
#include "tree/atomic_file.h"

namespace fasttree::app {
namespace {

namespace fs = std::filesystem;

/// Of the kinds that the paper has: a scanned surface, a building seen from inside, and detail in a
/// corner of a large space; the full ones with about as many triangles as its small scenes.
std::vector<std::string> built_in_scenes(bool quick) {
  if (quick) return {"scene:knot:5k", "scene:hall:5k", "scene:stadium:5k"};
  return {"scene:knot:70k", "scene:hall:80k", "scene:stadium:170k"};
}

/// Makes the folder, and tries a file in it: better now than after minutes of work.
void make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw Failure{kBadInput, fmt::format("cannot make the folder {}: {}; give another --out",
                                         folder, error.message())};
  }
  take(AtomicFile::create((fs::path(folder) / "report.html").string()));
}

void write_all(Context& context, const Evaluation& evaluation, const nlohmann::ordered_json& json,
               const std::string& folder) {
  const auto path = [&](const std::string& name) { return (fs::path(folder) / name).string(); };
  std::size_t count = 0;
  for (const NamedTable& named : all_tables(evaluation)) {
    context.output.file(named.table.csv(), path(named.name + ".csv"));
    ++count;
  }
  context.output.json(json, path("report.json"));
  context.output.file(page_of(evaluation), path("report.html"));
  context.output.line("");
  context.output.line("page                 {}", path("report.html"));
  context.output.line("figures              {} and {} tables as CSV", path("report.json"), count);
}

void summarise(Output& output, const Evaluation& evaluation) {
  output.line("");
  table_of(evaluation.table2, false, false).print(output);
  output.line("");
  for (const SkippedScene& scene : evaluation.skipped) {
    output.line("missing: {}: {}; {}", scene.scene, scene.reason, scene.remedy);
  }
}

}  // namespace

int reproduce_all(Context& context, EvaluationSettings settings, const std::string& folder,
                  std::optional<double> within_percent) {
  make_folder(folder);
  if (settings.scenes.empty()) settings.scenes = built_in_scenes(settings.quick);
  const Evaluation evaluation = evaluate(context, settings);
  const nlohmann::ordered_json json = json_of(evaluation);
  summarise(context.output, evaluation);
  write_all(context, evaluation, json, folder);
  context.output.json(json, context.common.json);
  for (const EvaluatedScene& scene : evaluation.scenes) {
    if (!scene.same_tree) {
      throw Failure{kCheckFailed,
                    fmt::format("{}: a machine's tree is not the library's; fasttree simulate "
                                "--verify says where they differ",
                                scene.name)};
    }
  }
  const double worst = worst_percent(evaluation.table2);
  if (within_percent && worst > *within_percent) {
    throw Failure{kCheckFailed, fmt::format("a ratio is {:.1f} % from 1, more than {} %", worst,
                                            *within_percent)};
  }
  return kDone;
}

}  // namespace fasttree::app
