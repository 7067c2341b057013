// SPDX-License-Identifier: Apache-2.0
// fasttree simulate: the files that it writes say the same as its JSON, and are whole.
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

using nlohmann::json;

const std::vector<std::string> kMachines = {"paper-asic65", "fasttree-2"};

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> list(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      list.emplace_back();
    } else {
      list.back() += c;
    }
  }
  return list;
}

TEST(CliSimulateFiles, CsvSumsToTheJson) {
  for (const std::string& machine : kMachines) {
    const Folder folder;
    const json run = run_json(
        {"simulate", "scene:knot:1500", "--config", machine, "--csv", folder.path("u.csv")});
    std::istringstream csv(read_file(folder.path("u.csv")));
    std::string line;
    ASSERT_TRUE(std::getline(csv, line));
    const std::vector<std::string> header = cells(line);
    std::map<std::string, std::size_t> column;
    for (std::size_t c = 0; c < header.size(); ++c) column[header[c]] = c;
    std::map<std::string, std::map<std::string, std::uint64_t>> sums;
    std::size_t rows = 0;
    while (std::getline(csv, line)) {
      const std::vector<std::string> row = cells(line);
      ASSERT_EQ(row.size(), header.size()) << line;
      ++rows;
      std::uint64_t stage = 0;
      for (const char* key : {"busy_cycles", "stalled_cycles", "idle_cycles"}) {
        const std::uint64_t cycles = std::stoull(row[column.at(key)]);
        sums[row[column.at("unit")]][key] += cycles;
        stage += cycles;
      }
      EXPECT_EQ(stage, std::stoull(row[column.at("stage_cycles")])) << line;
      EXPECT_EQ(row[column.at("config")], machine);
    }
    EXPECT_EQ(rows, run["units"].size() * run["stages"].size());
    for (const json& unit : run["units"]) {
      for (const char* key : {"busy_cycles", "stalled_cycles", "idle_cycles"}) {
        EXPECT_EQ(sums.at(unit["unit"]).at(key), unit[key].get<std::uint64_t>()) << unit["unit"];
      }
    }
  }
}

TEST(CliSimulateFiles, TimelineLiesInsideTheRunAndDoesNotOverlap) {
  for (const std::string& machine : kMachines) {
    const Folder folder;
    const json run = run_json(
        {"simulate", "scene:knot:3000", "--config", machine, "--timeline", folder.path("t.json")});
    const json trace = json::parse(read_file(folder.path("t.json")));
    // Events are in microseconds with three digits.
    const double end_us = run["time_ms"].get<double>() * 1000 + 0.0005;
    std::map<int, std::string> tracks;
    std::map<int, double> last_end;
    std::map<int, std::uint64_t> covered;
    std::map<std::string, std::map<std::string, std::uint64_t>> sums;
    double bandwidth_bytes = 0, last_ts = 0, last_value = 0;
    for (const json& event : trace["traceEvents"]) {
      const std::string phase = event["ph"];
      if (phase == "M") {
        if (event["name"] == "thread_name") tracks[event["tid"]] = event["args"]["name"];
        continue;
      }
      const double ts = event["ts"];
      EXPECT_GE(ts, 0.0);
      EXPECT_LE(ts, end_us);
      if (phase == "C") {
        EXPECT_GE(event["args"]["value"], 0.0);
        if (event["name"] == "bandwidth GB/s") {
          bandwidth_bytes += last_value * 1000 * (ts - last_ts);
          last_ts = ts;
          last_value = event["args"]["value"];
        }
        continue;
      }
      ASSERT_EQ(phase, "X");
      const int track = event["tid"];
      const double duration = event["dur"];
      EXPECT_GT(duration, 0.0);
      EXPECT_GE(ts, last_end[track] - 1e-6) << machine << event;
      EXPECT_LE(ts + duration, end_us) << machine << event;
      last_end[track] = ts + duration;
      if (event["args"].contains("busy_cycles")) {
        sums[tracks.at(track)]["busy"] += event["args"]["busy_cycles"].get<std::uint64_t>();
        sums[tracks.at(track)]["stalled"] += event["args"]["stalled_cycles"].get<std::uint64_t>();
      }
    }
    EXPECT_EQ(tracks.size(), run["units"].size() + 1);  // and the stages
    // Windows in which a unit was mostly idle have no slice.
    for (const json& unit : run["units"]) {
      EXPECT_LE(sums[unit["unit"]]["busy"], unit["busy_cycles"].get<std::uint64_t>());
      EXPECT_LE(sums[unit["unit"]]["stalled"], unit["stalled_cycles"].get<std::uint64_t>());
    }
    double bus_bytes = 0;
    for (const json& stage : run["stages"]) {
      bus_bytes += stage["read_bytes"].get<double>() + stage["write_bytes"].get<double>();
    }
    EXPECT_NEAR(bandwidth_bytes, bus_bytes, 0.01 * bus_bytes) << machine;
    // The stages' track is the first.
    EXPECT_EQ(tracks.at(1), "stages");
    EXPECT_NEAR(last_end.at(1), run["time_ms"].get<double>() * 1000, 0.001);
  }
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(CliSimulateFiles, HtmlNeedsNothingButItself) {
  for (const std::string& machine : kMachines) {
    const Folder folder;
    const json run = run_json({"simulate", "scene:knot:3000", "--config", machine, "--verify",
                               "--html", folder.path("r.html")});
    const std::string page = read_file(folder.path("r.html"));
    EXPECT_EQ(page.rfind("<!DOCTYPE html>", 0), 0u);
    for (const char* outside : {"http", "src=", "url(", "@import", "<script", "<link"}) {
      EXPECT_EQ(page.find(outside), std::string::npos) << outside;
    }
    // The stage bar, a strip a unit, bandwidth, latencies.
    EXPECT_EQ(count(page, "<svg"), 3 + run["units"].size());
    EXPECT_EQ(count(page, "<svg"), count(page, "</svg>"));
    EXPECT_EQ(count(page, "class=\"strip\""), run["units"].size());
    for (const char* tag : {"table", "div", "details", "tr", "td", "span", "p", "h2"}) {
      EXPECT_EQ(
          count(page, "<" + std::string(tag) + ">") + count(page, "<" + std::string(tag) + " "),
          count(page, "</" + std::string(tag) + ">"))
          << tag;
    }
    for (const json& unit : run["units"]) {
      EXPECT_NE(page.find(unit["unit"].get<std::string>()), std::string::npos);
    }
    for (const json& stage : run["stages"]) {
      EXPECT_NE(page.find("in stage " + stage["stage"].get<std::string>()), std::string::npos);
    }
    EXPECT_NE(page.find(run["tree_hash"].get<std::string>()), std::string::npos);
    EXPECT_NE(page.find("equal the reference builder"), std::string::npos);
    EXPECT_EQ(page.find("nan"), std::string::npos);
  }
}

TEST(CliSimulateFiles, TheTreeCanBeSavedAndVerified) {
  const Folder folder;
  const json run = run_json(
      {"simulate", "scene:knot:1500", "--config", "fasttree-2", "--out", folder.path("t")});
  const json verified =
      run_json({"verify", folder.path("t"), "--mesh", "scene:knot:1500", "--rays", "500"});
  EXPECT_EQ(verified["tree_hash"], run["tree_hash"]);
}

TEST(CliSimulateFiles, NamesOfScenesAreText) {
  const Folder folder;
  const std::string scene = folder.path("<a> & \"b\", c.obj");
  write_file(scene, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const RunResult result = run({"simulate", scene, "--html", folder.path("r.html"), "--timeline",
                                folder.path("t.json"), "--csv", folder.path("u.csv")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read_file(folder.path("r.html")).find("<a>"), std::string::npos);
  EXPECT_TRUE(json::accept(read_file(folder.path("t.json"))));
  EXPECT_NE(read_file(folder.path("u.csv")).find("\"\"b\"\""), std::string::npos);
}

TEST(CliSimulateFiles, PlacesThatCannotBeWrittenAreThree) {
  const Folder folder;
  const std::string nowhere = folder.path("no/such/file");
  for (const char* option : {"--csv", "--html", "--timeline", "--out", "--json"}) {
    const RunResult result = run({"simulate", "scene:knot:100", option, nowhere});
    EXPECT_EQ(result.exit_code, 3) << option;
    EXPECT_NE(result.err.find(nowhere), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace fasttree::cli
