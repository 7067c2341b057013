// SPDX-License-Identifier: Apache-2.0
// fasttree explore.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

using nlohmann::json;
using Row = std::map<std::string, std::string>;

/// Lines of CSV whose cells hold no quotes.
std::vector<Row> read_csv(const std::string& path) {
  std::istringstream text(read_file(path));
  std::vector<std::string> names;
  std::vector<Row> rows;
  for (std::string line; std::getline(text, line);) {
    EXPECT_EQ(line.find('"'), std::string::npos) << line;
    std::vector<std::string> cells;
    std::istringstream parts(line + ",");
    for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
    if (names.empty()) {
      names = cells;
      continue;
    }
    EXPECT_EQ(cells.size(), names.size()) << line;
    Row row;
    for (std::size_t i = 0; i < std::min(cells.size(), names.size()); ++i) row[names[i]] = cells[i];
    rows.push_back(row);
  }
  return rows;
}

std::vector<std::string> grid(const std::string& out, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments = {"explore",
                                        "--scene",
                                        "scene:knot:500",
                                        "--scene",
                                        "scene:hall:300",
                                        "--vary",
                                        "paper.bus_bytes_per_cycle=8,16,32",
                                        "--vary",
                                        "paper.prefix_sum_units=2,4"};
  if (!out.empty()) arguments.insert(arguments.end(), {"--out", out});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(CliExplore, AGridOverScenes) {
  const Folder folder;
  const std::string out = folder.path("o");
  const json all = run_json(grid(out));
  ASSERT_EQ(all["points"].size(), 6u);
  EXPECT_EQ(all["runs"], 12);
  EXPECT_EQ(all["resumed_runs"], 0);
  EXPECT_EQ(all["points"][0]["point"], "bus_bytes_per_cycle=8 prefix_sum_units=2");
  const std::vector<Row> rows = read_csv(out + "/results.csv");
  ASSERT_EQ(rows.size(), 12u);
  for (std::size_t p = 0; p < 6; ++p) {
    const json& point = all["points"][p];
    double product = 1;
    for (std::size_t s = 0; s < 2; ++s) {
      const json& run = point["runs"][s];
      const Row& row = rows[2 * p + s];
      EXPECT_EQ(row.at("status"), "done");
      EXPECT_EQ(row.at("key"), run["key"]);
      EXPECT_EQ(row.at("cycles"), std::to_string(run["cycles"].get<std::uint64_t>()));
      EXPECT_EQ(std::stod(row.at("time_ms")), run["time_ms"]);
      EXPECT_EQ(std::stod(row.at("area_65nm_mm2")), point["area_65nm_mm2"]);
      EXPECT_NEAR(run["energy_uj"],
                  run["machine_uj"].get<double>() + run["memory_uj"].get<double>(), 1e-9);
      // No configuration changes the tree.
      EXPECT_EQ(run["tree_hash"], all["points"][0]["runs"][s]["tree_hash"]);
      product *= run["time_ms"].get<double>();
    }
    EXPECT_NEAR(point["time_ms"], std::sqrt(product), 1e-12);
  }
  // A wider bus is not slower, and costs area.
  EXPECT_LT(all["points"][4]["time_ms"], all["points"][0]["time_ms"]);
  EXPECT_GT(all["points"][4]["area_65nm_mm2"], all["points"][0]["area_65nm_mm2"]);
  const std::string svg = read_file(out + "/pareto.svg");
  EXPECT_EQ(svg.rfind("<svg", 0), 0u);
  EXPECT_NE(svg.find("bus_bytes_per_cycle=32 prefix_sum_units=4"), std::string::npos);
  EXPECT_EQ(json::parse(read_file(out + "/explore.json")), all);
}

TEST(CliExplore, FrontsAsByBruteForce) {
  const json all = run_json(grid("", {"--vary", "memory.preset=ideal,lpddr3-1600-dual"}));
  const json& points = all["points"];
  ASSERT_EQ(points.size(), 12u);
  for (const auto& [cost, front] : {std::pair("area_65nm_mm2", "front_time_area"),
                                    std::pair("energy_uj", "front_time_energy")}) {
    int marked = 0;
    for (const json& a : points) {
      bool beaten = false;
      for (const json& b : points) {
        beaten |= b["time_ms"] <= a["time_ms"] && b[cost] <= a[cost] &&
                  (b["time_ms"] < a["time_ms"] || b[cost] < a[cost]);
      }
      EXPECT_EQ(a[front], !beaten) << a["point"];
      marked += a[front].get<bool>();
    }
    EXPECT_GT(marked, 0);
    EXPECT_LT(marked, 12);
  }
}

TEST(CliExplore, GoesOnWhereItWasStopped) {
  const Folder folder;
  const std::string whole = folder.path("whole"), part = folder.path("part");
  run_json(grid(whole));
  const std::string expected = read_file(whole + "/results.csv");
  // What a killed program leaves: some lines, in any order, and half of one.
  std::vector<std::string> lines;
  std::istringstream text(expected);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 13u);
  std::filesystem::create_directory(part);
  write_file(part + "/results.csv", lines[0] + "\n" + lines[7] + "\n" + lines[2] + "\n" +
                                        lines[12].substr(0, lines[12].size() / 2));
  const json resumed = run_json(grid(part));
  EXPECT_EQ(resumed["resumed_runs"], 2);
  EXPECT_EQ(read_file(part + "/results.csv"), expected);
  EXPECT_EQ(read_file(part + "/pareto.svg"), read_file(whole + "/pareto.svg"));
  // Once more: nothing is left to do. Another scene or another value is.
  EXPECT_EQ(run_json(grid(part))["resumed_runs"], 12);
  const json other = run_json(grid(part, {"--set", "paper.control_step_cycles=9"}));
  EXPECT_EQ(other["resumed_runs"], 0);
  EXPECT_EQ(read_csv(part + "/results.csv").size(), 24u);
}

TEST(CliExplore, ASceneThatChangedIsSimulatedAnew) {
  const Folder folder;
  const std::string scene = folder.path("s.obj"), out = folder.path("o");
  const std::vector<std::string> arguments = {"explore",           "--scene", scene, "--vary",
                                              "clock_mhz=100,200", "--out",   out};
  write_file(scene, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  run_json(arguments);
  write_file(scene, "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n");
  EXPECT_EQ(run_json(arguments)["resumed_runs"], 0);
  EXPECT_EQ(run_json(arguments)["resumed_runs"], 2);
}

TEST(CliExplore, KilledThenResumedEqualsOneGo) {
  const Folder folder;
  const auto arguments = [&](const std::string& out) {
    return std::vector<std::string>{"explore",
                                    "--scene",
                                    "scene:knot:3000",
                                    "--vary",
                                    "paper.bus_bytes_per_cycle=8,16,32",
                                    "--vary",
                                    "paper.radix_sort_radix_bits=2,3,4",
                                    "--threads",
                                    "1",
                                    "--out",
                                    folder.path(out)};
  };
  const std::string results = folder.path("part") + "/results.csv";
  RunSettings kill_it;
  kill_it.meanwhile = [&](int pid) {
    // After some lines.
    for (int i = 0; i < 3000; ++i) {
      std::error_code error;
      const auto size = std::filesystem::file_size(results, error);
      if (!error && size > 700) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    kill(pid, SIGKILL);
  };
  EXPECT_EQ(run(arguments("part"), kill_it).exit_code, 128 + SIGKILL);
  const json resumed = run_json(arguments("part"));
  EXPECT_GT(resumed["resumed_runs"], 0);
  EXPECT_LT(resumed["resumed_runs"], 9);
  run_json(arguments("whole"));
  EXPECT_EQ(read_file(results), read_file(folder.path("whole") + "/results.csv"));
}

TEST(CliExplore, CtrlCLeavesWhatIsDone) {
  const Folder folder;
  const std::string out = folder.path("o");
  RunSettings interrupt;
  interrupt.meanwhile = [&](int pid) {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    kill(pid, SIGINT);
  };
  const RunResult result = run(
      {"explore", "--scene", "scene:knot:200000", "--vary", "paper.prefix_sum_units=1,2,3,4,5,6",
       "--vary", "paper.bus_bytes_per_cycle=8,16,32", "--out", out},
      interrupt);
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_NE(result.err.find("the same command goes on"), std::string::npos) << result.err;
  for (const Row& row : read_csv(out + "/results.csv")) EXPECT_EQ(row.at("status"), "done");
}

TEST(CliExplore, TheSameOnAnyNumberOfThreads) {
  const Folder folder;
  run_json(grid(folder.path("1"), {"--threads", "1"}));
  run_json(grid(folder.path("5"), {"--threads", "5"}));
  // Memory for one at a time.
  run_json(grid(folder.path("m"), {"--threads", "5", "--memory-limit", "60M"}));
  for (const char* file : {"/results.csv", "/pareto.svg"}) {
    EXPECT_EQ(read_file(folder.path("1") + file), read_file(folder.path("5") + file));
    EXPECT_EQ(read_file(folder.path("1") + file), read_file(folder.path("m") + file));
  }
  const RunResult little = run(grid("", {"--memory-limit", "1M"}));
  EXPECT_EQ(little.exit_code, 4);
  EXPECT_NE(little.err.find("--memory-limit"), std::string::npos);
}

TEST(CliExplore, WhatEachAssumptionIsWorth) {
  const Folder folder;
  const json all = run_json(
      {"explore", "--scene", "scene:knot:300", "--sensitivity", "--out", folder.path("o")});
  const json& effects = all["sensitivity"];
  ASSERT_GT(effects.size(), 20u);
  double last = 1e9;
  std::map<std::string, double> by_change;
  for (const json& effect : effects) {
    const double size = std::abs(effect["time_percent"].get<double>());
    EXPECT_LE(size, last);
    last = size;
    by_change[effect["change"]] = effect["time_percent"];
  }
  EXPECT_GT(by_change.at("paper.bus_bytes_per_cycle=8"), 0);
  EXPECT_LE(by_change.at("memory.preset=ideal"), 0);
  // Each value follows from the runs.
  const double base = all["points"][0]["time_ms"];
  for (const json& point : all["points"]) {
    if (point["changes"].empty() || !point.contains("time_ms")) continue;
    EXPECT_NEAR(by_change.at(point["changes"][0]),
                (point["time_ms"].get<double>() / base - 1) * 100, 1e-9);
  }
  EXPECT_EQ(read_file(folder.path("o") + "/sensitivity.csv").rfind("change,", 0), 0u);
  // Only what was asked for.
  const json some = run_json({"explore", "--scene", "scene:knot:300", "--sensitivity", "--vary",
                              "paper.bus_bytes_per_cycle=8,16"});
  EXPECT_EQ(some["sensitivity"].size(), 1u);  // 16 is the base
}

TEST(CliExplore, PointsFromAFile) {
  const Folder folder;
  const std::string csv = folder.path("p.csv"), toml = folder.path("p.toml");
  write_file(csv, "name,paper.bus_bytes_per_cycle,memory.preset\nnarrow,8,\nideal,,ideal\n");
  write_file(toml,
             "[[point]]\nname = \"narrow\"\npaper.bus_bytes_per_cycle = 8\n"
             "[[point]]\nname = \"ideal\"\n[point.memory]\npreset = \"ideal\"\n");
  const json a = run_json({"explore", "--scene", "scene:knot:300", "--list", csv});
  const json b = run_json({"explore", "--scene", "scene:knot:300", "--list", toml});
  EXPECT_EQ(a["points"], b["points"]);
  ASSERT_EQ(a["points"].size(), 2u);
  EXPECT_EQ(a["points"][0]["point"], "narrow");
  EXPECT_EQ(a["points"][1]["changes"][0], "memory.preset=ideal");
}

TEST(CliExplore, APointThatAMachineRefusesIsAResult) {
  const Folder folder;
  const std::vector<std::string> arguments = {
      "explore", "--scene",       "scene:knot:300", "--vary", "paper.mark_cache_bytes=64,16384",
      "--out",   folder.path("o")};
  const json all = run_json(arguments);
  EXPECT_EQ(all["points"][1]["runs"][0]["status"], "done");
  const std::string status = all["points"][0]["runs"][0]["status"];
  EXPECT_EQ(status.rfind("refused: mark_cache_bytes", 0), 0u) << status;
  EXPECT_EQ(all["points"][0]["front_time_area"], false);
  EXPECT_EQ(run_json(arguments)["resumed_runs"], 2);
}

TEST(CliExplore, OurMachineToo) {
  const json all = run_json({"explore", "--config", "fasttree-2", "--scene", "scene:knot:2000",
                             "--vary", "fasttree2.lanes=1,2,3"});
  ASSERT_EQ(all["points"].size(), 3u);
  for (const json& point : all["points"]) {
    EXPECT_EQ(point["runs"][0]["status"], "done");
    EXPECT_GT(point["area_65nm_mm2"], 0);
  }
  EXPECT_LT(all["points"][0]["area_65nm_mm2"], all["points"][2]["area_65nm_mm2"]);
}

TEST(CliExplore, WrongUsageIsAnsweredWithTheRightOne) {
  const Folder folder;
  write_file(folder.path("bad.csv"), "paper.bus_bytes_per_cycle\n8,9\n");
  write_file(folder.path("bad.toml"), "[[point]]\npaper.bus_bytes_per_cycl = 8\n");
  write_file(folder.path("dir.csv"), "not,results\n");
  std::filesystem::create_directory(folder.path("o"));
  write_file(folder.path("o") + "/results.csv", "not,results\n1,2\n");
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    const char* part;
  };
  const std::string scene = "scene:knot:100", bus = "paper.bus_bytes_per_cycle=8";
  const std::vector<Case> cases = {
      {{"explore", "--vary", bus}, 2, "--scene"},
      {{"explore", "--scene", scene}, 2, "--vary"},
      {{"explore", "--scene", scene, "--vary", "bus"}, 2, "section.key=VALUE"},
      {{"explore", "--scene", scene, "--vary", bus, "--vary", bus}, 2, "twice"},
      {{"explore", "--scene", scene, "--vary", "paper.bus_byte_per_cycle=8"},
       2,
       "did you mean 'bus_bytes_per_cycle'"},
      {{"explore", "--scene", scene, "--vary", "paper.bus_bytes_per_cycle=9"}, 2, "power of two"},
      {{"explore", "--scene", scene, "--vary", bus, "--list", "x"}, 2, "--list"},
      {{"explore", "--scene", scene, "--vary", bus, "--config", "paper-asic6"}, 3, "paper-asic65"},
      {{"explore", "--scene", scene, "--list", folder.path("none.csv")}, 3, "none.csv"},
      {{"explore", "--scene", scene, "--list", folder.path("bad.csv")}, 3, "row 2"},
      {{"explore", "--scene", scene, "--list", folder.path("bad.toml")}, 3, "bus_bytes_per_cycle"},
      {{"explore", "--scene", scene, "--vary", bus, "--out", folder.path("o")}, 3, "results.csv"},
      {{"explore", "--scene", folder.path("none.ply"), "--vary", bus}, 3, "none.ply"}};
  for (const Case& c : cases) {
    const RunResult result = run(c.arguments);
    EXPECT_EQ(result.exit_code, c.exit_code) << c.part << ": " << result.err;
    EXPECT_NE(result.err.find(c.part), std::string::npos) << result.err << "lacks: " << c.part;
  }
}

}  // namespace
}  // namespace fasttree::cli
