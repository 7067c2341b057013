// SPDX-License-Identifier: Apache-2.0
// The paper's tables beside the model's and this machine's own figures.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "exploration.h"
#include "output.h"
#include "paper_tables.h"

namespace fasttree::app {

/// The scene of the paper that this one is, by its file's name and its size, or null.
const PaperBuild* paper_of(const ExploredScene& scene);

/// A value of ours beside the paper's, if it has one.
struct Compared {
  std::string scene;   ///< the paper's name, or the file's where it is no scene of the paper
  std::string figure;  ///< "FPGA at 163 MHz"
  std::string how;     ///< "paper-fpga: DDR3 timing"
  std::uint64_t triangles = 0;
  std::uint64_t paper_triangles = 0;  ///< 0: no scene of the paper
  double time_ms = 0;
  std::optional<double> paper_ms;
  /// Without a clock there are no cycles: the library's.
  std::optional<double> cycles_per_triangle, paper_cycles_per_triangle;
  std::string area_mm2, power_w;  ///< Table III
  std::string reason;
  bool measured = false;  ///< on this machine: another one, another time

  /// Ours over the paper's a triangle, so that a few triangles more do not count.
  std::optional<double> ratio() const;
};

/// Three rows a scene: the FPGA; the paper's way to the ASIC, which is the FPGA's cycles at 500
/// MHz; the ASIC against the timing of its own memory.
std::vector<Compared> reproduce_table2(const std::string& scene, const PaperBuild* paper,
                                       const ExploredRun& fpga, const ExploredRun& asic);

/// How long the library takes, on this machine.
struct LibraryTime {
  std::string profile;
  int threads = 0;
  double build_ms = 0;
};

/// The machines, then the library, on one scene.
std::vector<Compared> reproduce_table3(const std::string& scene, const PaperBuild* paper,
                                       const std::vector<const ExploredRun*>& machines,
                                       const std::vector<LibraryTime>& library);

/// How far the ratio that is furthest from 1 is from it, in per cent.
double worst_percent(const std::vector<Compared>& rows);

/// `costs`: with area and power; `reasons`: with the reasons, which are long.
Table table_of(const std::vector<Compared>& rows, bool costs, bool reasons);
nlohmann::ordered_json json_of(const Compared& row);

/// Table III as the paper prints it.
Table paper_table3_table();
nlohmann::ordered_json json_of(const PaperPlatform& platform);

}  // namespace fasttree::app
