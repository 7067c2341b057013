// SPDX-License-Identifier: Apache-2.0
// What the paper's Tables II and III print, and nothing else.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace fasttree::app {

/// Clocks of the prototype, and of the ASIC.
inline constexpr double kPaperFpgaMhz = 163, kPaperAsicMhz = 500;

/// A row of Table II.
struct PaperBuild {
  const char* scene;  ///< as the paper calls it
  const char* file;   ///< what its file is called here, without an extension
  std::uint64_t triangles;
  double fpga_ms;  ///< the prototype at 163 MHz
  double asic_ms;  ///< at 500 MHz
  double asic_fps;
};
std::span<const PaperBuild> paper_table2();

/// The row for a file of this name and size, or null. Other exports of a model differ by a few
/// triangles; one of another size is another scene, whatever its file is called.
const PaperBuild* paper_build(const std::string& file_stem, std::uint64_t triangles);

/// A column of Table III.
struct PaperPlatform {
  const char* work;
  const char* platform;
  const char* scene;
  double build_ms;
  double clock_mhz;
  double process_nm;
  const char* area_mm2;  ///< as printed: "143 x 2", "at most 1.4"
  const char* power_w;
};
std::span<const PaperPlatform> paper_table3();

/// Table III's time of RayCore, which the paper compares itself with.
inline constexpr double kRayCoreMs = 20;

}  // namespace fasttree::app
