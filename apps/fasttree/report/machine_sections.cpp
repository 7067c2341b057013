// SPDX-License-Identifier: Apache-2.0
// The sections about what the paper leaves open: where cycles and bytes go, another machine, and
// what each assumption is worth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "model/report/area.h"
#include "model/report/energy.h"
#include "model/report/html_plots.h"
#include "model/report/text.h"
#include "report/plots.h"
#include "report/sections.h"
#include "report/tables.h"

namespace fasttree::app {
namespace {

using model::escaped_html;
using report::note;
using report::paragraph;

constexpr std::size_t kTornadoRows = 16;
constexpr double kVisible = 0.05;  // per cent: less is not drawn

std::string cycles_plot(const Evaluation& evaluation) {
  std::vector<std::string> legend;
  std::vector<report::BarGroup> groups;
  for (const EvaluatedScene& scene : evaluation.scenes) {
    report::BarGroup group{scene.name, {}};
    for (const Machine machine : kTimedMachines) {
      const ExploredRun& run = scene.runs[machine];
      report::Bar bar{run.config, {}, fmt::format("{:.2f}", run.cycles_per_triangle)};
      for (const auto& [stage, cycles] : run.stages) {
        const auto found = std::find(legend.begin(), legend.end(), stage);
        const auto colour = static_cast<std::size_t>(found - legend.begin());
        if (found == legend.end()) legend.push_back(stage);
        bar.parts.push_back(
            {colour, static_cast<double>(cycles) / static_cast<double>(scene.triangles)});
      }
      group.bars.push_back(std::move(bar));
    }
    groups.push_back(std::move(group));
  }
  return report::figure(
      report::stacked_bars(legend, "cycles a triangle", groups, true),
      "Cycles a triangle by stage, all on one scale. In fasttree-2 the stage radix_sort sorts "
      "buckets on chip and writes nodes and ids: nothing is left for the other stages to do.");
}

std::string bandwidth_figure(const EvaluatedScene& scene, const DesignPoint& machine,
                             const ExploredRun& run) {
  model::SimulationReport report;
  report.scene = scene.name;
  report.config = machine.config;
  report.result = *run.account;
  return report::figure(model::bandwidth_plot(report),
                        fmt::format("{} on {}: GB/s over ms, {:.2f} GB/s on average", scene.name,
                                    run.config, run.bandwidth_gb_s));
}

std::string tornado_of(const Sensitivity& sensitivity) {
  std::vector<report::TornadoRow> rows;
  for (const KeyChange& change : sensitivity.changes) {
    const std::string label = fmt::format("{} ({})", change.key, change.base);
    auto row = std::find_if(rows.begin(), rows.end(),
                            [&](const report::TornadoRow& r) { return r.label == label; });
    if (row == rows.end()) {
      if (rows.size() == kTornadoRows || std::abs(change.time_percent) < kVisible) continue;
      row = rows.insert(rows.end(), {label, {}});
    }
    row->bars.push_back({change.value, change.time_percent});
  }
  return report::figure(
      report::tornado("build time", rows),
      fmt::format("{} on {}, which takes {:.3f} ms: how much longer (to the right) or shorter (to "
                  "the left) when one key is changed; in brackets what it holds.",
                  sensitivity.config, sensitivity.scene, sensitivity.base.time_ms));
}

}  // namespace

report::PageSection machines_section(const Evaluation& evaluation) {
  const Table table = machine_table(evaluation);
  std::vector<report::BarGroup> groups;
  for (const EvaluatedScene& scene : evaluation.scenes) {
    report::BarGroup group{scene.name, {}};
    if (scene.paper != nullptr) {
      group.bars.push_back({"the paper's ASIC",
                            {{2, scene.paper->asic_ms}},
                            fmt::format("{:.2f} ms, {:.2f} mm2", scene.paper->asic_ms, 5.4)});
    }
    for (const Machine machine : {kAsic65, kFastTree2}) {
      const ExploredRun& run = scene.runs[machine];
      group.bars.push_back({run.config,
                            {{machine == kAsic65 ? 0U : 4U, run.time_ms}},
                            fmt::format("{:.2f} ms, {:.2f} mm2", run.time_ms, run.area_65nm_mm2)});
    }
    groups.push_back(std::move(group));
  }
  return {"machines", "The paper's machine and fasttree-2",
          paragraph("Configuration <code>fasttree-2</code> builds the same tree in another way: it "
                    "sorts on chip and writes each array once. Clock and memory are those of the "
                    "paper's ASIC.") +
              report::figure(
                  report::stacked_bars({"paper-asic65", "", "in the paper", "", "fasttree-2"}, "ms",
                                       groups, false),
                  "Milliseconds a build at 500 MHz, and area at 65 nm; each scene has a "
                  "scale of its own.") +
              report::html_table("All machines", table.cells(), {1}) +
              note("Area: " + escaped_html(model::area_basis()) + ".") +
              note("Power and energy: " + escaped_html(model::energy_basis()) + ".")};
}

report::PageSection stages_section(const Evaluation& evaluation) {
  const char* what = "Cycles and bytes by stage";
  return {
      "stages", "Where the cycles go",
      cycles_plot(evaluation) +
          report::folded(what, report::html_table(what, stage_table(evaluation).cells(), {1, 2}))};
}

report::PageSection bandwidth_section(const Evaluation& evaluation) {
  std::string body = paragraph(
      "Bytes over the bus during a build, beside what memory and bus can move at most. Thin lines "
      "are where one stage ends and the next begins. fasttree-2 counts bytes when the memory "
      "accepts a request: after a pause its queues fill faster than the peak, for a moment.");
  for (const EvaluatedScene& scene : evaluation.scenes) {
    body += report::subheading(scene.name) + "<div class=\"pair\">\n";
    for (const Machine machine : {kAsic65, kFastTree2}) {
      body += bandwidth_figure(scene, evaluation.machines[machine], scene.runs[machine]);
    }
    body += "</div>\n";
  }
  return {"bandwidth", "Bandwidth over time", body};
}

report::PageSection assumptions_section(const Evaluation& evaluation) {
  std::string body = paragraph(
      "The paper leaves much open. Each key below fills a gap or repeats what the paper states; "
      "one at a time is changed, and the machine simulated again. Two designs whose difference is "
      "less "
      "than what an open assumption is worth are not told apart.");
  for (const Sensitivity& sensitivity : evaluation.sensitivities) {
    std::string all = report::html_table(
        fmt::format("What one change is worth: {} on {}, from {:.3f} ms, {:.2f} mm2 at 65 "
                    "nm, {:.1f} uJ",
                    sensitivity.config, sensitivity.scene, sensitivity.base.time_ms,
                    sensitivity.base.area_65nm_mm2, sensitivity.base.energy_uj),
        change_table(sensitivity).cells(), {6});
    for (const std::string& refused : sensitivity.refused) all += note(escaped_html(refused));
    body += report::subheading(sensitivity.config) + tornado_of(sensitivity) +
            report::folded("All changes of " + sensitivity.config + ", with area and energy", all);
  }
  return {"assumptions", "What each assumption is worth", body};
}

}  // namespace fasttree::app
