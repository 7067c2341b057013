// SPDX-License-Identifier: Apache-2.0
// What a device is asked to build, what it says of itself, and what it counted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/tree.h"

namespace fasttree::device {

/// The part of BuildSettings that goes to a device. Engine `library` follows all of it. For a
/// machine, the model's or the RTL's, its configuration decides.
struct Order {
  Profile profile = Profile::realtime;
  AxisSchedule axes = AxisSchedule::cyclic;
  int depth = kAutoDepth;
  int extra_depth = 1;
  double max_growth = 6.0;
  std::uint64_t memory_limit_bytes = 0;
  SahCosts sah_costs;
  Implementation implementation = Implementation::fast;
  Simd simd = Simd::widest;
};

Order order_of(const BuildSettings& settings);
BuildSettings settings_of(const Order& order);

struct Description {
  std::string engine;   ///< "library", "model", "rtl"
  std::string config;   ///< of a machine; empty for the library
  std::string program;  ///< what runs it, with its version
  std::uint64_t most_scene_bytes = 0;
  bool busy = false;  ///< with a session
};

/// One step of a build. A machine counts cycles, the library time; the other is zero.
struct StageCount {
  std::string stage;
  std::uint64_t begin_cycle = 0;
  std::uint64_t end_cycle = 0;
  double ms = 0;
};

struct Counters {
  std::uint64_t cycles = 0;  ///< 0 for the library
  double clock_mhz = 0;      ///< 0 for the library
  double build_ms = 0;       ///< on a machine: its cycles at its clock
  std::vector<StageCount> stages;
};

struct Outcome {
  Tree tree;
  Counters counters;
};

}  // namespace fasttree::device
