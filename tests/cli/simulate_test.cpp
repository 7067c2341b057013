// SPDX-License-Identifier: Apache-2.0
// fasttree simulate: the account adds up, the tree is the library's, and what cannot be done is
// answered with what can.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

using nlohmann::json;

const std::vector<std::string> kMachines = {"paper-asic65", "paper-fpga", "fasttree-2"};

std::uint64_t whole(const json& value) {
  return value.get<std::uint64_t>();
}

/// Cycles of every stage, by its place and name.
std::vector<std::pair<std::string, std::uint64_t>> stage_cycles(const json& run) {
  std::vector<std::pair<std::string, std::uint64_t>> stages;
  for (const json& stage : run["stages"]) {
    stages.emplace_back(stage["stage"].get<std::string>(), whole(stage["cycles"]));
  }
  return stages;
}

TEST(CliSimulate, StagesFillTheRun) {
  for (const std::string& machine : kMachines) {
    const json run = run_json({"simulate", "scene:knot:1500", "--config", machine});
    std::uint64_t next = 0;
    for (const json& stage : run["stages"]) {
      EXPECT_EQ(whole(stage["begin_cycle"]), next) << machine << stage["stage"];
      EXPECT_GT(whole(stage["cycles"]), 0u) << machine << stage["stage"];
      next += whole(stage["cycles"]);
    }
    EXPECT_EQ(next, whole(run["cycles"])) << machine;
  }
}

TEST(CliSimulate, ThePapersMachineHasTheSixSteps) {
  const json run = run_json({"simulate", "scene:knot:1500", "--config", "paper-asic65"});
  std::vector<std::string> names;
  for (const auto& [name, cycles] : stage_cycles(run)) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"scene_bound", "morton_code", "radix_sort",
                                             "leaf_node", "internal_node", "path_compression"}));
}

TEST(CliSimulate, EveryCycleOfEveryUnitIsAccountedForOnce) {
  for (const std::string& machine : kMachines) {
    const json run = run_json({"simulate", "scene:knot:1500", "--config", machine});
    const auto stages = stage_cycles(run);
    EXPECT_GT(run["units"].size(), 5u);
    for (const json& unit : run["units"]) {
      ASSERT_EQ(unit["stages"].size(), stages.size()) << machine << unit["unit"];
      std::uint64_t busy = 0;
      for (std::size_t s = 0; s < stages.size(); ++s) {
        const json& part = unit["stages"][s];
        EXPECT_EQ(part["stage"], stages[s].first);
        EXPECT_EQ(
            whole(part["busy_cycles"]) + whole(part["stalled_cycles"]) + whole(part["idle_cycles"]),
            stages[s].second)
            << machine << unit["unit"] << stages[s].first;
        std::uint64_t on = 0;
        for (const auto& [reason, cycles] : part["stalled_on_cycles"].items()) on += whole(cycles);
        EXPECT_EQ(on, whole(part["stalled_cycles"])) << machine << unit["unit"];
        busy += whole(part["busy_cycles"]);
      }
      EXPECT_EQ(whole(unit["busy_cycles"]), busy);
      EXPECT_EQ(busy + whole(unit["stalled_cycles"]) + whole(unit["idle_cycles"]),
                whole(run["cycles"]));
    }
  }
}

TEST(CliSimulate, FiguresFollowFromEachOther) {
  for (const std::string& machine : kMachines) {
    const json run = run_json({"simulate", "scene:knot:1500", "--config", machine});
    const double cycles = run["cycles"];
    EXPECT_DOUBLE_EQ(run["cycles_per_triangle"], cycles / run["triangles"].get<double>());
    EXPECT_DOUBLE_EQ(run["time_ms"], cycles / run["clock_mhz"].get<double>() / 1000);
    EXPECT_NEAR(run["frames_per_s"].get<double>() * run["time_ms"].get<double>(), 1000, 1e-6);
    EXPECT_GT(run["simulation_cycles_per_s"], 0.0);
    EXPECT_GE(run["references"], run["triangles"]);

    const json& memory = run["memory"];
    EXPECT_NEAR(memory["bandwidth_gb_s"].get<double>() * run["time_ms"].get<double>() * 1e6,
                memory["read_bytes"].get<double>() + memory["write_bytes"].get<double>(), 1)
        << machine;
    EXPECT_GT(memory["bandwidth_share"], 0.0);
    EXPECT_LE(memory["bandwidth_share"], 1.0);
    std::uint64_t reads = 0;
    for (const json& bucket : memory["read_latency_histogram"]) reads += whole(bucket);
    EXPECT_EQ(reads, whole(memory["reads"])) << machine;
    for (const json& stage : run["stages"]) {
      std::uint64_t read = 0, written = 0;
      for (const json& traffic : stage["traffic"]) {
        read += whole(traffic["read_bytes"]);
        written += whole(traffic["write_bytes"]);
      }
      EXPECT_EQ(read, whole(stage["read_bytes"]));
      EXPECT_EQ(written, whole(stage["write_bytes"]));
    }
  }
}

TEST(CliSimulate, MarkCacheCountsWhatItIsAsked) {
  const json cache =
      run_json({"simulate", "scene:knot:1500", "--config", "paper-asic65"})["mark_cache"];
  EXPECT_GT(whole(cache["reads"]), 0u);
  EXPECT_GT(whole(cache["writes"]), 0u);
  EXPECT_LE(whole(cache["read_hits"]), whole(cache["reads"]));
  EXPECT_LE(whole(cache["write_hits"]), whole(cache["writes"]));
  EXPECT_GT(cache["hit_share"], 0.5);
  EXPECT_LE(cache["hit_share"], 1.0);
}

TEST(CliSimulate, AreaAndEnergyAreSumsOfTheirUnits) {
  for (const std::string& machine : kMachines) {
    const json run = run_json({"simulate", "scene:knot:500", "--config", machine});
    for (const auto& [table, column] :
         std::map<std::string, std::string>{{"area", "mm2_65nm"}, {"energy", "busy_uj"}}) {
      double sum = 0;
      for (const json& unit : run[table]["units"]) sum += unit[column].get<double>();
      EXPECT_GT(sum, 0.0) << machine << table;
      EXPECT_NEAR(sum, run[table]["total"][column].get<double>(), 1e-9 * sum) << machine << table;
      EXPECT_FALSE(run[table]["basis"].get<std::string>().empty());
    }
  }
}

TEST(CliSimulate, TheTreeIsTheLibrarys) {
  const std::map<std::string, std::string> sections = {
      {"paper-asic65", "paper"}, {"paper-fpga", "paper"}, {"fasttree-2", "fasttree2"}};
  for (const auto& [machine, section] : sections) {
    for (const std::string axes : {"cyclic", "longest"}) {
      for (const std::string depth : {"auto", "7"}) {
        std::vector<std::string> arguments = {
            "simulate", "scene:hall:1000", "--config", machine, "--set", section + ".axes=" + axes};
        if (depth != "auto") {
          arguments.insert(arguments.end(), {"--set", section + ".depth=" + depth});
          if (section == "paper") {
            arguments.insert(arguments.end(), {"--set", "paper.depth_fixed=true"});
          }
        }
        const json run = run_json(arguments);
        const json built = run_json(
            {"build", "scene:hall:1000", "--profile", "paper", "--axes", axes, "--depth", depth});
        EXPECT_EQ(run["tree_hash"], built["tree_hash"]) << machine << axes << depth;
        EXPECT_EQ(run["depth"], built["depth"]);
        EXPECT_EQ(run["leaves"], built["leaves"]);
        EXPECT_EQ(run["references"], built["references"]);
      }
    }
  }
}

TEST(CliSimulate, VerifySaysWhatItCompared) {
  for (const std::string& machine : kMachines) {
    const RunResult result = run({"simulate", "scene:knot:800", "--config", machine, "--verify"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("equal the reference builder's"), std::string::npos);
    const json run = run_json({"simulate", "scene:knot:800", "--config", machine, "--verify"});
    EXPECT_EQ(run["compared"], true);
    EXPECT_TRUE(run["difference"].is_null());
  }
}

TEST(CliSimulate, SettingsChangeTheMachine) {
  const auto cycles = [](const std::vector<std::string>& set) {
    std::vector<std::string> arguments = {"simulate", "scene:knot:1500"};
    for (const std::string& assignment : set) {
      arguments.insert(arguments.end(), {"--set", assignment});
    }
    const json run = run_json(arguments);
    return std::pair{whole(run["cycles"]), run["tree_hash"].get<std::string>()};
  };
  const auto [base, hash] = cycles({});
  const auto [wide, wide_hash] = cycles({"paper.bus_bytes_per_cycle=32", "memory.preset=ideal"});
  EXPECT_LT(wide, base);
  EXPECT_EQ(wide_hash, hash);
  // The last one counts.
  EXPECT_EQ(cycles({"paper.bus_bytes_per_cycle=32", "paper.bus_bytes_per_cycle=16"}).first, base);
}

TEST(CliSimulate, AConfigurationCanBePrintedChangedAndGivenAsAFile) {
  const Folder folder;
  const RunResult printed = run({"simulate", "--config", "paper-fpga", "--set",
                                 "paper.morton_code_units=2", "--print-config"});
  EXPECT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_NE(printed.out.find("morton_code_units = 2"), std::string::npos);
  write_file(folder.path("two.toml"), printed.out);
  const json named = run_json({"simulate", "scene:knot:500", "--config", "paper-fpga", "--set",
                               "paper.morton_code_units=2"});
  const json file = run_json({"simulate", "scene:knot:500", "--config", folder.path("two.toml")});
  EXPECT_EQ(file["cycles"], named["cycles"]);
  EXPECT_EQ(file["units"], named["units"]);
}

TEST(CliSimulate, ConfigurationsAreListed) {
  const RunResult text = run({"simulate", "--list-configs"});
  EXPECT_EQ(text.exit_code, 0);
  const json list = run_json({"simulate", "--list-configs"});
  std::vector<std::string> names;
  for (const json& config : list["configs"]) names.push_back(config["config"]);
  for (const std::string& machine : kMachines) {
    EXPECT_NE(std::find(names.begin(), names.end(), machine), names.end()) << machine;
    EXPECT_NE(text.out.find(machine), std::string::npos);
  }
}

TEST(CliSimulate, DegenerateScenesHaveReportsToo) {
  const Folder folder;
  write_file(folder.path("empty.obj"), "v 0 0 0\n");
  write_file(folder.path("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const char* scene : {"empty.obj", "one.obj"}) {
    for (const std::string& machine : kMachines) {
      const RunResult result = run({"simulate", folder.path(scene), "--config", machine, "--verify",
                                    "--html", folder.path("r.html"), "--timeline",
                                    folder.path("t.json"), "--csv", folder.path("u.csv")});
      // A reader may refuse a file without faces; a machine may not.
      if (result.exit_code == 3 && scene == std::string("empty.obj")) continue;
      EXPECT_EQ(result.exit_code, 0) << machine << scene << result.err;
      const std::string page = read_file(folder.path("r.html"));
      EXPECT_EQ(page.find("nan"), std::string::npos) << machine << scene;
      EXPECT_TRUE(json::accept(read_file(folder.path("t.json"))));
    }
  }
}

void expect_error(const RunResult& result, int exit_code, const std::string& part) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(result.err.rfind("fasttree: error: ", 0), 0u) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err << "lacks: " << part;
}

TEST(CliSimulate, WrongUsageIsAnsweredWithTheRightOne) {
  const std::string scene = "scene:knot:100";
  expect_error(run({"simulate"}), 2, "SCENE is required");
  expect_error(run({"simulate", scene, "--verfy"}), 2, "did you mean --verify");
  expect_error(run({"simulate", scene, "--timelin", "x"}), 2, "did you mean --timeline");
  expect_error(run({"simulate", scene, "--max-cycles", "many"}), 2, "whole number");
  expect_error(run({"simulate", scene, "--set", "paper.bus_byte_per_cycle=8"}), 2,
               "did you mean 'bus_bytes_per_cycle'");
  expect_error(run({"simulate", scene, "--set", "papr.axes=cyclic"}), 2, "did you mean 'paper'");
  expect_error(run({"simulate", scene, "--set", "paper.axes=cylic"}), 2, "cyclic");
  expect_error(run({"simulate", scene, "--set", "paper.axes"}), 2, "section.key=value");
  expect_error(run({"simulate", scene, "--set", "fasttree2.lanes=2"}), 2, "fasttree-2");
  expect_error(run({"simulat", scene}), 2, "did you mean simulate");
}

TEST(CliSimulate, AnUnknownConfigurationIsAnsweredWithThoseThereAre) {
  const RunResult result = run({"simulate", "scene:knot:100", "--config", "paper-asic56"});
  expect_error(result, 3, "did you mean 'paper-asic");
  for (const std::string& machine : kMachines) expect_error(result, 3, machine);
  const Folder folder;
  write_file(folder.path("wrong.toml"), "architecture = \"paper\"\n[paper]\nbus_width = 3\n");
  expect_error(run({"simulate", "scene:knot:100", "--config", folder.path("wrong.toml")}), 3,
               "line 3");
}

TEST(CliSimulate, LimitsAndStuckMachinesAreFour) {
  for (const std::string& machine : kMachines) {
    expect_error(run({"simulate", "scene:knot:100", "--config", machine, "--max-cycles", "10"}), 4,
                 "cycles");
    EXPECT_EQ(run({"simulate", "scene:knot:100", "--config", machine, "--max-cycles", "10000000"})
                  .exit_code,
              0);
  }
  // A device that is too small for the scene, its pairs and its tree.
  expect_error(
      run({"simulate", "scene:knot:20k", "--config", "paper-asic65", "--set", "memory.rows=16"}), 4,
      "the scene needs");
  // A memory that takes a millisecond to answer looks dead to the machine's control.
  const RunResult stuck = run({"simulate", "scene:knot:100", "--set", "memory.preset=fixed",
                               "--set", "memory.latency_ns=1000000"});
  expect_error(stuck, 4, "stuck in stage scene_bound");
  expect_error(stuck, 4, "scene_reader waits for");
  expect_error(stuck, 4, "bus waits for memory");
}

TEST(CliSimulate, ControlCIsOneHundredAndThirty) {
  RunSettings interrupt;
  interrupt.meanwhile = [](int pid) { kill(pid, SIGINT); };
  const Folder folder;
  const RunResult result =
      run({"simulate", "scene:cloud:200000", "--json", folder.path("s.json")}, interrupt);
  expect_error(result, 130, "cancelled");
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
}  // namespace fasttree::cli
