// SPDX-License-Identifier: Apache-2.0
// The paper's Figure 1 as rows: how a frame's time splits, with the library's builder and with an
// accelerator in its place.
#pragma once

#include <string>
#include <vector>

#include "report/evaluation.h"

namespace fasttree::app {

struct SplitRow {
  std::string scene;
  std::string builder;     ///< "library, profile paper", "paper-asic65"
  bool simulated = false;  ///< the tree's time is the model's; all else is measured
  double tree_ms = 0, layout_ms = 0, trace_ms = 0;

  double frame_ms() const { return tree_ms + layout_ms + trace_ms; }
  double construction_percent() const { return 100 * tree_ms / frame_ms(); }
};

/// The accelerators build profile paper's tree, so tracing it takes as long as the library's.
std::vector<SplitRow> figure1_rows(const EvaluatedScene& scene);

}  // namespace fasttree::app
