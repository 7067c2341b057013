// SPDX-License-Identifier: Apache-2.0
// Everything that the paper evaluates, made anew: what `fasttree reproduce all` writes as a page,
// as JSON and as CSV.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "design_points.h"
#include "exploration.h"
#include "paper_tables.h"
#include "report/claims.h"
#include "report/frame_split.h"
#include "report/sensitivity.h"
#include "reproduction.h"
#include "table1.h"

namespace fasttree::app {

/// The machines that every scene is built on, in this order.
enum Machine : std::size_t { kFpga, kAsic65, kAsic28, kFastTree2, kMachines };

/// Those whose cycles and bytes differ: the version in 28 nm runs as that in 65 nm does.
inline constexpr Machine kTimedMachines[] = {kFpga, kAsic65, kFastTree2};

struct EvaluationSettings {
  std::vector<std::string> scenes;
  bool quick = false;        ///< small pictures, one measured frame, a small scene for changes
  std::uint32_t repeat = 5;  ///< measured frames, for a median
  std::uint64_t memory_bytes = 0;
};

struct EvaluatedScene {
  std::string name;                   ///< the paper's, or its own where the paper has no such scene
  std::string source;                 ///< the file's name, or the procedural scene
  const PaperBuild* paper = nullptr;  ///< its row of Table II, where it is one of the paper's
  std::uint64_t triangles = 0;
  std::vector<ExploredRun> runs;  ///< on each Machine
  FrameSplit frame;
  /// All machines and the library have built the same tree.
  bool same_tree = false;
};

/// A scene that is not in the evaluation.
struct SkippedScene {
  std::string scene;
  std::string reason;
  std::string remedy;  ///< how to get it
};

struct Evaluation {
  EvaluationSettings settings;
  std::string processor;
  int threads = 0;
  std::vector<DesignPoint> machines;
  std::vector<EvaluatedScene> scenes;
  std::vector<SkippedScene> skipped;
  std::vector<ModuleResources> table1;
  std::vector<Compared> table2, table3;
  std::vector<Claim> claims;
  std::vector<Sensitivity> sensitivities;  ///< of the paper's machine, of fasttree-2
};

/// Loads, simulates, builds, traces and draws. Throws Failure: cancelled, a scene that cannot be
/// read, no scene left.
Evaluation evaluate(Context& context, const EvaluationSettings& settings);

}  // namespace fasttree::app
