// SPDX-License-Identifier: Apache-2.0
// The page's head, how its figures were made, and all of it together.
#include <fmt/format.h>

#include <algorithm>

#include "model/report/text.h"
#include "report/sections.h"

namespace fasttree::app {
namespace {

using model::escaped_html;
using report::note;
using report::paragraph;

/// The scene that the paper compares itself with others on, or the first one.
const EvaluatedScene& main_scene(const Evaluation& evaluation) {
  for (const EvaluatedScene& scene : evaluation.scenes) {
    if (scene.paper != nullptr) return scene;
  }
  return evaluation.scenes.front();
}

std::string summary_tiles(const Evaluation& evaluation) {
  const EvaluatedScene& scene = main_scene(evaluation);
  const ExploredRun &asic = scene.runs[kAsic65], &ours = scene.runs[kFastTree2];
  std::vector<std::pair<std::string, std::string>> list = {
      {fmt::format("{:.2f} ms", asic.time_ms),
       fmt::format("{} on the paper's ASIC, simulated{}", scene.name,
                   scene.paper != nullptr
                       ? fmt::format("; the paper: {:g} ms", scene.paper->asic_ms)
                       : "")},
      {fmt::format("{:.2f} ms", ours.time_ms),
       fmt::format("{} on fasttree-2, {:.1f} times as fast", scene.name,
                   asic.time_ms / ours.time_ms)}};
  const auto compared = std::count_if(evaluation.table2.begin(), evaluation.table2.end(),
                                      [](const Compared& row) { return row.ratio().has_value(); });
  if (compared > 0) {
    list.emplace_back(
        fmt::format("{:.0f} %", worst_percent(evaluation.table2)),
        fmt::format("the furthest of {} times of Table II from the paper's", compared));
  }
  list.emplace_back(fmt::format("{:.2f}", evaluation.table1.back().lut_ratio()),
                    "LUTs of the RTL over the paper's (Table I)");
  const auto same = std::count_if(evaluation.scenes.begin(), evaluation.scenes.end(),
                                  [](const EvaluatedScene& s) { return s.same_tree; });
  list.emplace_back(fmt::format("{} of {}", same, evaluation.scenes.size()),
                    "scenes with the same tree, to the byte, from all machines and the library");
  return report::tiles(list);
}

}  // namespace

report::PageSection method_section(const Evaluation& evaluation) {
  const EvaluationSettings& settings = evaluation.settings;
  std::string machine =
      std::string("<p ") + report::kMeasured +
      ">Measured on: " + escaped_html(evaluation.processor) +
      fmt::format(
          ", {} thread{}; frames of {} rays at most, the median of {} "
          "after one that warms up.</p>\n",
          evaluation.threads, evaluation.threads == 1 ? "" : "s",
          with_commas(std::max_element(evaluation.scenes.begin(), evaluation.scenes.end(),
                                       [](const EvaluatedScene& a, const EvaluatedScene& b) {
                                         return a.frame.rays < b.frame.rays;
                                       })
                          ->frame.rays),
          settings.quick ? 1 : settings.repeat);
  return {
      "method", "How these figures were made",
      paragraph("Written by <code>fasttree reproduce all</code>, version " FASTTREE_VERSION
                ". Rows marked \u25F7 were measured on one machine and differ from run to run; "
                "all else is simulated or counted and the same every time.") +
          machine +
          paragraph("The accelerators are models, clocked cycle by cycle beside a model of "
                    "their memory's banks and rows; their trees are their own work. Table I is "
                    "synthesis of the RTL without place and route. Values of the paper are as "
                    "it prints them: X. Liu, Y. Deng, Y. Ni, Z. Li, <cite>FastTree: A Hardware "
                    "KD-Tree Construction Acceleration Engine for Real-Time Ray "
                    "Tracing</cite>, DATE 2015.") +
          paragraph("The same figures lie beside this page as <code>report.json</code>, in full "
                    "precision, and as CSV files, one a table.")};
}

std::string page_of(const Evaluation& evaluation) {
  std::string lead = paragraph(
      "The evaluation of the FastTree paper, made anew: its machine as a cycle-level model, its "
      "RTL through synthesis, and the tree by a library on a processor, each value beside the "
      "paper's.");
  if (evaluation.settings.quick) {
    lead += note(
        "A quick run: small pictures, one measured frame a scene, assumptions changed on a "
        "small scene.");
  }
  const auto of_paper = std::count_if(evaluation.scenes.begin(), evaluation.scenes.end(),
                                      [](const EvaluatedScene& s) { return s.paper != nullptr; });
  if (of_paper < static_cast<std::ptrdiff_t>(paper_table2().size())) {
    lead +=
        note(fmt::format("{} of the paper's {} scenes are here; <a href=\"#scenes\">what is "
                         "missing</a> is named.",
                         of_paper, paper_table2().size()));
  }
  return report::html_page(
      "FastTree: the paper's evaluation", lead + summary_tiles(evaluation),
      {scenes_section(evaluation), figure1_section(evaluation), table1_section(evaluation),
       table2_section(evaluation), table3_section(evaluation), text_section(evaluation),
       machines_section(evaluation), stages_section(evaluation), bandwidth_section(evaluation),
       assumptions_section(evaluation), method_section(evaluation)});
}

}  // namespace fasttree::app
