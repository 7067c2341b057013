// SPDX-License-Identifier: Apache-2.0
// Simulates design points over scenes, one on a core, and keeps what came of each as soon as it is
// known.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "design_points.h"
#include "inputs.h"
#include "model/report/simulation.h"

namespace fasttree::app {

/// One point on one scene. Also a row of results.csv.
struct ExploredRun {
  std::string key;  ///< of configuration, scene and program: equal keys, equal results
  std::string point, changes, config, scene;
  std::string status;  ///< "done", or why not
  std::uint64_t triangles = 0, cycles = 0;
  double time_ms = 0, cycles_per_triangle = 0, bandwidth_gb_s = 0;
  double luts = 0, registers = 0, ram_kbits = 0;
  double area_65nm_mm2 = 0, area_28nm_mm2 = 0;
  double machine_uj = 0, memory_uj = 0, energy_uj = 0, machine_power_w = 0;
  std::string tree_hash;
  /// Cycles of each stage, in their order; not in the file.
  std::vector<std::pair<std::string, std::uint64_t>> stages;
  /// The whole account, without the tree, where explore() was asked for timelines; not in the file.
  std::shared_ptr<const model::SimulationResult> account;

  bool done() const { return status == "done"; }
};

std::string csv_header();
std::string csv_line(const ExploredRun& run);  ///< ends with a newline

/// A file of results that grows by a line a run. What an interrupted program left of a last line is
/// taken off; runs that are there need not be made again.
class ResultsFile {
 public:
  /// `path` empty: nothing is kept.
  explicit ResultsFile(std::string path);
  ~ResultsFile();
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;

  const ExploredRun* find(const std::string& key) const;
  void append(const ExploredRun& run);
  /// Writes it anew: these runs in this order, then all others that are in it.
  void rewrite(const std::vector<ExploredRun>& runs);

 private:
  void open();

  std::string path_;
  std::vector<ExploredRun> known_;
  int descriptor_ = -1;
};

struct ExploredScene {
  std::string name;  ///< as given
  LoadedScene scene;
  std::uint64_t hash = 0;
};
std::vector<ExploredScene> load_scenes(Context& context, const std::vector<std::string>& names);

/// Bytes that a simulation may take, at most.
std::uint64_t simulation_bytes(const model::MachineConfig& config, std::uint64_t triangles);

struct Exploration {
  std::vector<ExploredRun> runs;  ///< point by point, in it scene by scene; without those not made
  std::size_t resumed = 0;        ///< found in the file
  bool cancelled = false;
};

/// On context.threads cores, as many at once as `memory_bytes` allows. A point that a machine
/// refuses is a result too, with the reason as its status. With `timeline_windows` each run that is
/// made keeps its account with a timeline of about so many samples.
Exploration explore(Context& context, const std::vector<DesignPoint>& points,
                    const std::vector<ExploredScene>& scenes, ResultsFile& file,
                    std::uint64_t memory_bytes, std::uint32_t timeline_windows = 0);

}  // namespace fasttree::app
