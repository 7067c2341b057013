// SPDX-License-Identifier: Apache-2.0
// Points of a design space: a base configuration, each with some keys changed.
#pragma once

#include <string>
#include <vector>

#include "model/config/machine_config.h"

namespace fasttree::app {

/// More than anyone can wait for, and less than fills the memory.
inline constexpr std::size_t kMaxDesignPoints = 100'000;

struct DesignPoint {
  std::string label;                 ///< "bus_bytes_per_cycle=8"; "base" where nothing changes
  std::vector<std::string> changes;  ///< "section.key=value", in the order they are applied
  model::MachineConfig config;
};

/// "section.key=v1,v2,..." taken apart.
struct Variation {
  std::string key;
  std::vector<std::string> values;
};
std::vector<Variation> parse_variations(const std::vector<std::string>& texts);

/// All combinations, the last key's values fastest.
std::vector<DesignPoint> grid_points(const model::MachineConfig& base,
                                     const std::vector<Variation>& variations);

/// The base, then each value by itself; values that the base has already are left out.
std::vector<DesignPoint> single_points(const model::MachineConfig& base,
                                       const std::vector<Variation>& variations);

/// What single_points() takes where nothing is said: for every assumption that the machine's keys
/// declare, half and twice its value, or the other choices; and the choices of the memory.
std::vector<Variation> assumptions(const model::MachineConfig& base);

/// What a key ("section.key") means, as its comment says, and holds.
struct KeyInfo {
  std::string comment, value;
};
KeyInfo key_info(const model::MachineConfig& config, const std::string& key);

/// From a file: CSV with keys as its header and a point a row, or TOML with [[point]] tables; a
/// column or key "name" labels a point.
std::vector<DesignPoint> listed_points(const model::MachineConfig& base, const std::string& path);

/// Rows of CSV with quotes undone; lines that end without a newline are left out where
/// `whole_lines` says so.
std::vector<std::vector<std::string>> parse_csv(const std::string& text, bool whole_lines);

}  // namespace fasttree::app
