// SPDX-License-Identifier: Apache-2.0
// The sections about what the paper prints: its figures, tables and sentences.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "model/report/text.h"
#include "report/base64.h"
#include "report/figure1.h"
#include "report/plots.h"
#include "report/sections.h"
#include "report/tables.h"

namespace fasttree::app {
namespace {

using model::escaped_html;
using report::Bar;
using report::BarGroup;
using report::note;
using report::paragraph;

/// Why ours differ, each reason once, with all that it is the reason of.
class Reasons {
 public:
  void add(const std::string& of, const std::string& reason) {
    if (reason.empty()) return;
    for (auto& [known, labels] : list_) {
      if (known != reason) continue;
      labels += "; " + of;
      return;
    }
    list_.emplace_back(reason, of);
  }
  std::string html(const std::string& caption) const {
    report::HtmlTable table(caption, {"figure", "reason"});
    table.words(0).words(1);
    for (const auto& [reason, labels] : list_) table.row({labels, reason});
    return table.html();
  }

 private:
  std::vector<std::pair<std::string, std::string>> list_;
};

std::string reasons_of(const std::vector<Compared>& rows) {
  Reasons reasons;
  for (const Compared& row : rows) reasons.add(row.scene + ", " + row.figure, row.reason);
  return reasons.html("Reasons for the differences");
}

std::vector<bool> measured_rows(const std::vector<Compared>& rows) {
  std::vector<bool> list;
  for (const Compared& row : rows) list.push_back(row.measured);
  return list;
}

Bar bar_of(const std::string& label, std::size_t colour, double ms) {
  return {label, {{colour, ms}}, fmt::format("{:.2f} ms", ms)};
}

/// Times of Table II a scene, ours beside the paper's.
std::string table2_bars(const Evaluation& evaluation) {
  std::vector<BarGroup> groups;
  for (const Compared& row : evaluation.table2) {
    if (groups.empty() || groups.back().title != row.scene) groups.push_back({row.scene, {}});
    std::vector<Bar>& bars = groups.back().bars;
    Bar ours = bar_of(row.figure, 0, row.time_ms);
    if (const auto ratio = row.ratio()) ours.text += fmt::format(", x {:.2f}", *ratio);
    // The paper has one figure for both ways to the ASIC.
    const bool repeated = row.how == "paper-asic65";
    if (row.paper_ms && !repeated) {
      bars.push_back(bar_of(row.figure + ", paper", 2, *row.paper_ms));
    }
    bars.push_back(std::move(ours));
  }
  return report::stacked_bars({"simulated", "", "in the paper"}, "ms", groups, false);
}

}  // namespace

report::PageSection scenes_section(const Evaluation& evaluation) {
  std::string gallery = "<div class=\"gallery\">\n";
  for (const EvaluatedScene& scene : evaluation.scenes) {
    const FrameSplit& frame = scene.frame;
    gallery += report::figure(
        report::picture(report::png_uri(frame.png),
                        fmt::format("{}, drawn by tracing rays through its kd-tree", scene.name),
                        frame.picture_width, frame.picture_height),
        fmt::format("{}: {} triangles", scene.name, with_commas(scene.triangles)));
  }
  gallery += "</div>\n";
  std::string body =
      paragraph(
          "The paper's Figure 5 shows its test scenes. These are drawn through the tree that "
          "all machines of this page and the library have built.") +
      gallery + report::html_table("Scenes and their trees", scene_table(evaluation).cells(), {1}) +
      note(
          "References a triangle: in how many cells of the grid one lies. <em>Same tree</em>: the "
          "trees of all simulated machines have the hash of the library's, profile paper.");
  if (!evaluation.skipped.empty()) {
    body += report::subheading("What is missing") +
            report::html_table("Scenes that are not in this report",
                               skipped_table(evaluation).cells(), {1, 2}) +
            note(
                "A scene of the paper is known by its file's name and its count of triangles, "
                "within 1 %. Any other goes under its own name, without a value of the paper.");
  }
  return {"scenes", "Scenes (Figure 5)", body};
}

report::PageSection figure1_section(const Evaluation& evaluation) {
  std::vector<BarGroup> groups;
  double least = 100, most = 0;
  for (const EvaluatedScene& scene : evaluation.scenes) {
    BarGroup group{scene.name, {}};
    for (const SplitRow& row : figure1_rows(scene)) {
      if (!row.simulated) {
        least = std::min(least, row.construction_percent());
        most = std::max(most, row.construction_percent());
      }
      group.bars.push_back({row.builder,
                            {{0, row.tree_ms}, {1, row.layout_ms}, {2, row.trace_ms}},
                            fmt::format("{:.1f} % construction", row.construction_percent()),
                            true});
    }
    groups.push_back(std::move(group));
  }
  const auto parts = figure1_table(evaluation).cells();
  return {
      "figure1", "Frame time: construction and traversal (Figure 1)",
      paragraph("The paper's Figure 1, after Wu et al., shows that construction dominates the "
                "frames of six scenes; it prints no numbers. Here a frame is the tree, the "
                "tracer's own layout of it, and the primary and shadow rays, all on this "
                "machine's processor. In the rows of an accelerator the tree's time is the "
                "simulated machine's, at its configured clock; it builds the tree of profile "
                "paper, so layout and tracing are that tree's.") +
          fmt::format("<p {}>With the library's builders the tree is {:.1f} to {:.1f} % of a frame "
                      "here. The paper's figure is of trees by the surface-area heuristic on a "
                      "GPU, which take much longer to build: Table III has 59 ms for the "
                      "Bunny.</p>\n",
                      report::kMeasured, least, most) +
          report::figure(report::stacked_bars({"tree", "layout for the tracer", "tracing"}, "ms",
                                              groups, false),
                         "Each scene has a scale of its own: its slowest frame fills the width.") +
          report::html_table("Parts of a frame", parts, {1},
                             std::vector<bool>(parts.size() - 1, true))};
}

report::PageSection table1_section(const Evaluation& evaluation) {
  auto cells = table_of(evaluation.table1, true).cells();
  for (auto& row : cells) row.pop_back();  // the reasons have a table of their own
  Reasons reasons;
  for (const ModuleResources& row : evaluation.table1) reasons.add(row.module, row.reason);
  return {
      "table1", "Hardware resources (Table I)",
      paragraph("What synthesis makes of the RTL, beside the paper's prototype on a Virtex-7.") +
          report::html_table("LUTs, registers and block RAM a module, ours and the paper's",
                             cells) +
          reasons.html("Reasons for the differences") + note(escaped_html(table1_basis()))};
}

report::PageSection table2_section(const Evaluation& evaluation) {
  const Table table = table_of(evaluation.table2, false, false);
  return {
      "table2", "Build times (Table II)",
      paragraph("Three figures a scene: the FPGA prototype; the ASIC as the paper has it, the "
                "prototype's cycles at 500 MHz; and the ASIC against the timing of its own "
                "memory.") +
          report::figure(table2_bars(evaluation),
                         "Milliseconds a build; each scene has a scale of its own. The factor is "
                         "our time over the paper's, a triangle.") +
          report::html_table("Build times, ours and the paper's", table.cells(), {1, 2}) +
          reasons_of(evaluation.table2) +
          note("A ratio is our time over the paper's, a triangle.")};
}

report::PageSection table3_section(const Evaluation& evaluation) {
  const Table table = table_of(evaluation.table3, true, false);
  return {"table3", "Against other builders (Table III)",
          report::html_table("In the paper", paper_table3_table().cells(), {1, 2}) +
              report::html_table("Here", table.cells(), {1, 2}, measured_rows(evaluation.table3)) +
              reasons_of(evaluation.table3) +
              note(fmt::format("RayCore takes {:g} ms for a scene of 64,000 triangles; only scenes "
                               "of about that size are set over it. The library runs on this "
                               "machine's processor, whose area and power are not known here.",
                               kRayCoreMs))};
}

report::PageSection text_section(const Evaluation& evaluation) {
  const Table table = claim_table(evaluation);
  return {
      "text", "Figures in the paper's text",
      paragraph("What sections IV and V say besides the tables, beside configuration "
                "<code>paper-asic65</code>.") +
          report::html_table("Figures of the text, ours and the paper's", table.cells(), {0, 5})};
}

}  // namespace fasttree::app
