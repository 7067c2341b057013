// SPDX-License-Identifier: Apache-2.0
#include "reproduction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace fasttree::app {
namespace {

double cycles_of(double ms, double mhz, std::uint64_t triangles) {
  return ms * mhz * 1e3 / static_cast<double>(triangles);
}

Compared row_of(const std::string& scene, const PaperBuild* paper, const ExploredRun& run) {
  Compared row;
  row.scene = scene;
  row.triangles = run.triangles;
  row.time_ms = run.time_ms;
  row.cycles_per_triangle = run.cycles_per_triangle;
  if (paper != nullptr) row.paper_triangles = paper->triangles;
  return row;
}

void set_paper(Compared& row, double ms, double mhz) {
  row.paper_ms = ms;
  row.paper_cycles_per_triangle = cycles_of(ms, mhz, row.paper_triangles);
}

/// "radix_sort takes 71 % of the cycles; 3.2 GB/s"
std::string where_time_goes(const ExploredRun& run) {
  const auto longest =
      std::max_element(run.stages.begin(), run.stages.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (longest == run.stages.end() || run.cycles == 0) return "";
  return fmt::format(
      "{} takes {:.0f} % of the cycles", longest->first,
      100.0 * static_cast<double>(longest->second) / static_cast<double>(run.cycles));
}

std::string other_size(const Compared& row) {
  if (row.paper_triangles == 0) return "; no scene of the paper";
  if (row.paper_triangles == row.triangles) return "";
  return fmt::format("; {} triangles, in the paper {}: compared a triangle",
                     with_commas(row.triangles), with_commas(row.paper_triangles));
}

std::string number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

}  // namespace

const PaperBuild* paper_of(const ExploredScene& scene) {
  return paper_build(std::filesystem::path(scene.name).stem().string(),
                     scene.scene.view.triangle_count);
}

std::optional<double> Compared::ratio() const {
  if (!paper_ms || paper_triangles == 0 || triangles == 0) return std::nullopt;
  return time_ms / static_cast<double>(triangles) /
         (*paper_ms / static_cast<double>(paper_triangles));
}

std::vector<Compared> reproduce_table2(const std::string& scene, const PaperBuild* paper,
                                       const ExploredRun& fpga, const ExploredRun& asic) {
  Compared prototype = row_of(scene, paper, fpga);
  prototype.figure = "FPGA, 163 MHz";
  prototype.how = "paper-fpga";
  if (paper != nullptr) set_paper(prototype, paper->fpga_ms, kPaperFpgaMhz);
  prototype.reason = fmt::format("{}; the paper leaves the bus and its memory traffic open{}",
                                 where_time_goes(fpga), other_size(prototype));

  Compared scaled = row_of(scene, paper, fpga);
  scaled.figure = "ASIC, scaled";
  scaled.how = "paper-fpga x 163/500";
  scaled.time_ms = fpga.time_ms * kPaperFpgaMhz / kPaperAsicMhz;
  if (paper != nullptr) set_paper(scaled, paper->asic_ms, kPaperAsicMhz);
  scaled.reason =
      "the paper's ASIC times are its FPGA's times 163/500, memory included" + other_size(scaled);

  Compared timed = row_of(scene, paper, asic);
  timed.figure = "ASIC, own memory";
  timed.how = "paper-asic65";
  if (paper != nullptr) set_paper(timed, paper->asic_ms, kPaperAsicMhz);
  timed.reason = fmt::format(
      "{:+.1f} % cycles over the FPGA: {:.2f} GB/s out of LPDDR3, whose latency the faster clock "
      "makes longer{}",
      (asic.cycles_per_triangle / fpga.cycles_per_triangle - 1) * 100, asic.bandwidth_gb_s,
      other_size(timed));
  return {prototype, scaled, timed};
}

std::vector<Compared> reproduce_table3(const std::string& scene, const PaperBuild* paper,
                                       const std::vector<const ExploredRun*>& machines,
                                       const std::vector<LibraryTime>& library) {
  const bool has_paper = paper != nullptr && std::string(paper->file) == "bunny";
  std::vector<Compared> rows;
  for (const ExploredRun* run : machines) {
    Compared row = row_of(scene, paper, *run);
    row.figure = run->config;
    row.how = "simulated";
    const bool small = run->config == "paper-asic28";
    row.area_mm2 = fmt::format("{:.2f}", small ? run->area_28nm_mm2 : run->area_65nm_mm2);
    // Power scales as the paper's does, 0.8 W for 3.9 W.
    row.power_w = fmt::format("{:.2f}", run->machine_power_w * (small ? 0.8 / 3.9 : 1));
    const bool of_paper = run->config.rfind("paper-asic", 0) == 0;
    if (has_paper && of_paper) set_paper(row, paper->asic_ms, kPaperAsicMhz);
    row.reason = of_paper ? "area is the paper's by calibration; power is the run's mean, the "
                            "paper's with everything busy"
                          : "no machine of the paper; area and power at its size of a gate, 65 nm";
    rows.push_back(std::move(row));
  }
  for (const LibraryTime& time : library) {
    Compared row;
    row.scene = scene;
    row.figure = fmt::format("library, profile {}", time.profile);
    row.how = fmt::format("measured, {} thread{}", time.threads, time.threads == 1 ? "" : "s");
    row.triangles = rows.empty() ? 0 : rows.front().triangles;
    row.time_ms = time.build_ms;
    row.area_mm2 = row.power_w = "-";
    row.measured = true;
    row.reason = "this machine's processor; nothing of the paper to compare with";
    rows.push_back(std::move(row));
  }
  return rows;
}

double worst_percent(const std::vector<Compared>& rows) {
  double worst = 0;
  for (const Compared& row : rows) {
    if (const auto ratio = row.ratio()) worst = std::max(worst, std::abs(*ratio - 1) * 100);
  }
  return worst;
}

Table table_of(const std::vector<Compared>& rows, bool costs, bool reasons) {
  std::vector<std::string> header = {"scene", "figure", "how", "ours ms", "paper ms", "ratio"};
  if (costs) {
    header.insert(header.end(), {"over RayCore", "mm2", "W"});
  } else {
    header.insert(header.end(), {"cycles/tri", "paper c/tri", "FPS"});
  }
  if (reasons) header.emplace_back("reason");
  Table table(header);
  for (const Compared& row : rows) {
    std::vector<std::string> cells = {row.scene,
                                      row.figure,
                                      row.how,
                                      fmt::format("{:.2f}", row.time_ms),
                                      number(row.paper_ms, 1),
                                      number(row.ratio(), 3)};
    if (costs) {
      // RayCore's scene has 64,000 triangles: nothing to compare much larger or smaller ones with.
      const bool comparable = row.triangles >= 51'200 && row.triangles <= 76'800;
      cells.push_back(comparable ? fmt::format("{:.1f}x", kRayCoreMs / row.time_ms) : "-");
      cells.push_back(row.area_mm2);
      cells.push_back(row.power_w);
    } else {
      cells.push_back(number(row.cycles_per_triangle, 2));
      cells.push_back(number(row.paper_cycles_per_triangle, 2));
      cells.push_back(fmt::format("{:.0f}", 1000 / row.time_ms));
    }
    if (reasons) cells.push_back(row.reason);
    table.row(std::move(cells));
  }
  return table;
}

Table paper_table3_table() {
  Table table({"in the paper", "platform", "scene", "ms", "MHz", "nm", "mm2", "W"});
  for (const PaperPlatform& p : paper_table3()) {
    table.row({p.work, p.platform, p.scene, fmt::format("{:g}", p.build_ms),
               fmt::format("{:g}", p.clock_mhz), fmt::format("{:g}", p.process_nm), p.area_mm2,
               p.power_w});
  }
  return table;
}

nlohmann::ordered_json json_of(const Compared& row) {
  const auto value = [](const std::optional<double>& v) {
    return v ? nlohmann::ordered_json(*v) : nlohmann::ordered_json(nullptr);
  };
  nlohmann::ordered_json json = {
      {"scene", row.scene},
      {"figure", row.figure},
      {"how", row.how},
      {"triangles", row.triangles},
      {"time_ms", row.time_ms},
      {"fps", 1000 / row.time_ms},
      {"paper_time_ms", value(row.paper_ms)},
      {"ratio", value(row.ratio())},
      {"cycles_per_triangle", value(row.cycles_per_triangle)},
      {"paper_cycles_per_triangle", value(row.paper_cycles_per_triangle)}};
  if (!row.area_mm2.empty()) {
    json["area_mm2"] = row.area_mm2;
    json["power_w"] = row.power_w;
  }
  json["measured"] = row.measured;
  json["reason"] = row.reason;
  return json;
}

nlohmann::ordered_json json_of(const PaperPlatform& p) {
  return {{"work", p.work},         {"platform", p.platform},   {"scene", p.scene},
          {"time_ms", p.build_ms},  {"clock_mhz", p.clock_mhz}, {"process_nm", p.process_nm},
          {"area_mm2", p.area_mm2}, {"power_w", p.power_w}};
}

}  // namespace fasttree::app
