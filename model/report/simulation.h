// SPDX-License-Identifier: Apache-2.0
// What a run of the accelerator's model gives: the tree, and the account of every cycle and byte.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fasttree/device_image.h"
#include "fasttree/tree.h"
#include "model/kernel/unit.h"
#include "model/memory/memory.h"

namespace fasttree::model {

/// Bytes over the bus for one purpose ("scene read", "pairs written") in one stage.
struct Traffic {
  std::string purpose;
  std::uint64_t read_bytes = 0;
  std::uint64_t write_bytes = 0;
};

/// One step of the build. Stages of a pipelined machine may overlap: begin and end say so.
struct StageRecord {
  std::string name;  ///< the stem: "scene_bound", "morton_code", "radix_sort", ...
  std::uint64_t begin_cycle = 0;
  std::uint64_t end_cycle = 0;  ///< one past the last
  std::vector<Traffic> traffic;
};

/// One unit's cycles, by stage (as many entries as stages).
struct UnitRecord {
  std::string name;
  std::string kind;
  std::vector<std::string> stall_reasons;
  std::vector<Activity> by_stage;
};

/// A window of the timeline, for plots and traces.
struct TimelineSample {
  std::uint64_t begin_cycle = 0;
  std::uint32_t cycles = 0;
  std::vector<std::uint32_t> busy_cycles;     ///< a unit
  std::vector<std::uint32_t> stalled_cycles;  ///< a unit
  std::uint64_t bus_bytes = 0;
};

struct CacheStatistics {
  std::uint64_t reads = 0;
  std::uint64_t read_hits = 0;
  std::uint64_t writes = 0;
  std::uint64_t write_hits = 0;
  std::uint64_t write_backs = 0;
};

/// The arrays between the steps, as found in the model's memory; for comparison with the
/// reference's. Filled only when asked for.
struct IntermediateArrays {
  Box3 bounds;
  std::vector<std::uint32_t> unsorted_codes, unsorted_ids;
  std::vector<std::uint32_t> sorted_codes, sorted_ids;
  std::vector<std::uint32_t> leaf_codes, leaf_first, leaf_count;
  std::vector<std::uint32_t> mark_words;
  std::vector<std::uint32_t> node_words;  ///< four a node: lower, upper, split plane, axis
  std::uint32_t root = 0;                 ///< a child, as in the device image
};

struct SimulationResult {
  std::string config;
  double clock_mhz = 0;
  std::uint64_t triangles = 0;
  std::uint64_t references = 0;
  std::uint64_t leaves = 0;
  std::uint64_t cycles = 0;  ///< from start to the tree's last byte in memory
  std::vector<StageRecord> stages;
  std::vector<UnitRecord> units;
  std::vector<TimelineSample> timeline;
  CacheStatistics mark_cache;
  MemoryTraits memory_traits;
  MemoryStatistics memory;
  Tree tree;
  std::string broken_tree;  ///< SimulationOptions::keep_broken: why `tree` is empty
  IntermediateArrays arrays;

  double time_ms() const;
};

/// How to run: what to keep, and a callback for progress and cancelling (false cancels).
struct SimulationOptions {
  bool keep_arrays = false;
  /// What the machine left may not form a tree: give the result with its arrays all the same.
  bool keep_broken = false;
  std::uint32_t timeline_windows = 400;  ///< about so many samples; 0: none
  std::function<bool(const char* stage, double fraction)> progress;
  std::uint64_t max_cycles = 0;  ///< 0: no limit; a run past it ends with resource_limit
};

}  // namespace fasttree::model
