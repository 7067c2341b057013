// SPDX-License-Identifier: Apache-2.0
#include "report/figure1.h"

namespace fasttree::app {

std::vector<SplitRow> figure1_rows(const EvaluatedScene& scene) {
  std::vector<SplitRow> rows;
  for (const MeasuredFrame& frame : scene.frame.library) {
    rows.push_back({scene.name, "library, profile " + frame.profile, false, frame.tree_ms,
                    frame.layout_ms, frame.trace_ms});
  }
  const MeasuredFrame& paper = scene.frame.library.front();
  for (const Machine machine : kTimedMachines) {
    rows.push_back({scene.name, scene.runs[machine].config, true, scene.runs[machine].time_ms,
                    paper.layout_ms, paper.trace_ms});
  }
  return rows;
}

}  // namespace fasttree::app
