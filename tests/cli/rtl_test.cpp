// SPDX-License-Identifier: Apache-2.0
// fasttree simulate --engine rtl and fasttree diff: the verilated accelerator from the outside, its
// waveforms, and what cannot be done answered with what can.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

using nlohmann::json;

const std::string kScene = "scene:knot:100";

void expect_error(const RunResult& result, int exit_code, const std::string& part) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(result.err.rfind("fasttree: error: ", 0), 0u) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err << "lacks: " << part;
}

std::vector<std::string> rtl(std::vector<std::string> more = {}) {
  std::vector<std::string> arguments = {"simulate",   kScene,     "--config",
                                        "paper-fpga", "--engine", "rtl"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// Whether the program was built with Verilator. One without says what is missing.
bool built_with_rtl() {
  static const RunResult result = run(rtl());
  if (result.exit_code == 0) return true;
  expect_error(result, 2, "built without the RTL");
  return false;
}

#define SKIP_WITHOUT_RTL() \
  if (!built_with_rtl()) GTEST_SKIP() << "the program was built without the RTL"

/// What the header of an FST file says. Numbers are big-endian.
struct FstHeader {
  explicit FstHeader(const std::string& path) : text(read_file(path)) {}

  std::uint64_t at(std::size_t offset) const {
    std::uint64_t value = 0;
    for (std::size_t i = offset; i < offset + 8 && i < text.size(); ++i) {
      value = value << 8 | static_cast<std::uint8_t>(text[i]);
    }
    return value;
  }
  /// The first block is the header: kind 0, 329 bytes long, with Euler's number in the writer's
  /// byte order.
  bool valid() const { return text.size() > 330 && text[0] == 0 && at(1) == 329 && euler(); }
  bool euler() const {
    const std::string there = text.substr(25, 8);
    return there == "\x69\x57\x14\x8b\x0a\xbf\x05\x40" ||
           there == "\x40\x05\xbf\x0a\x8b\x14\x57\x69";
  }
  std::uint64_t start() const { return at(9); }
  std::uint64_t end() const { return at(17); }
  std::uint64_t scopes() const { return at(41); }
  std::uint64_t signals() const { return at(49); }

  std::string text;
};

TEST(CliRtl, ItsReportIsTheModels) {
  SKIP_WITHOUT_RTL();
  const json built = run_json(rtl({"--verify"}));
  const json model =
      run_json({"simulate", kScene, "--config", "paper-fpga", "--engine", "model", "--verify"});
  EXPECT_EQ(built["engine"], "rtl");
  EXPECT_EQ(model["engine"], "model");
  EXPECT_EQ(built["tree_hash"], model["tree_hash"]);
  EXPECT_EQ(built["compared"], true);
  EXPECT_TRUE(built["difference"].is_null());
  std::set<std::string> units, expected, keys, model_keys;
  for (const json& unit : built["units"]) units.insert(unit["unit"]);
  for (const json& unit : model["units"]) expected.insert(unit["unit"]);
  for (const auto& [key, value] : built.items()) keys.insert(key);
  for (const auto& [key, value] : model.items()) model_keys.insert(key);
  EXPECT_EQ(units, expected);
  EXPECT_EQ(keys, model_keys);
  ASSERT_EQ(built["stages"].size(), model["stages"].size());
  std::uint64_t next = 0;
  for (std::size_t s = 0; s < built["stages"].size(); ++s) {
    const json& stage = built["stages"][s];
    EXPECT_EQ(stage["stage"], model["stages"][s]["stage"]);
    EXPECT_EQ(stage["begin_cycle"], next);
    next += stage["cycles"].get<std::uint64_t>();
    EXPECT_EQ(stage["write_bytes"], model["stages"][s]["write_bytes"]) << stage["stage"];
  }
  // A cycle before the first stage looks at the order.
  EXPECT_EQ(built["cycles"], next + 1);
}

TEST(CliRtl, WavesAreAnFstOfTheCyclesAskedFor) {
  SKIP_WITHOUT_RTL();
  const Folder folder;
  const auto waves = [&](const std::string& window) {
    const std::string file = folder.path(window + ".fst");
    const RunResult result = run(rtl({"--wave", window, "--wave-file", file}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find(file), std::string::npos) << result.out;
    const FstHeader header(file);
    EXPECT_TRUE(header.valid()) << window;
    EXPECT_GT(header.scopes(), 20u) << window;
    EXPECT_GT(header.signals(), 1000u) << window;
    return header;
  };
  // Two points in time a cycle: before its edge, and after it.
  const FstHeader some = waves("100:150");
  EXPECT_EQ(some.end() - some.start() + 1, 2 * 50u);
  const FstHeader later = waves("120:150");
  EXPECT_EQ(later.end(), some.end());
  EXPECT_EQ(later.start(), some.start() + 2 * 20);
  const FstHeader rest = waves("130:");
  EXPECT_EQ(rest.start(), later.start() + 2 * 10);
  const std::uint64_t cycles = run_json(rtl())["cycles"];
  EXPECT_GE(rest.end() - rest.start() + 1, 2 * (cycles - 130));
  EXPECT_LT(rest.end() - rest.start(), 2 * (cycles - 130 + 8));
}

TEST(CliRtl, WrongWindowsAreAnsweredWithRightOnes) {
  const Folder folder;
  const std::string file = folder.path("w.fst");
  for (const char* window : {"5", "9:3", "7:7", "a:9", "3:b", "1:2:3", "3 : 9", "+3:9", "1.5:9",
                             "1:99999999999999999999"}) {
    expect_error(run(rtl({"--wave", window, "--wave-file", file})), 2,
                 "--wave " + std::string(window) + " is not FROM:TO");
  }
  expect_error(run(rtl({"--wave", ":0"})), 2, "such as 1000:3000");
  expect_error(run({"simulate", kScene, "--config", "paper-fpga", "--wave", "1:9"}), 2,
               "--engine rtl");
  expect_error(run(rtl({"--wave-file", file})), 2, "--wave FROM:TO");
  expect_error(run(rtl({"--wav", "1:9"})), 2, "did you mean --wave");
  expect_error(run(rtl({"--engin", "rtl"})), 2, "did you mean --engine");
  expect_error(run({"simulate", kScene, "--engine", "rlt"}), 2, "did you mean rtl");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(CliRtl, WavesThatCannotBeWrittenFail) {
  SKIP_WITHOUT_RTL();
  const Folder folder;
  const std::string nowhere = folder.path("no/such/file.fst");
  expect_error(run(rtl({"--wave", "10:20", "--wave-file", nowhere})), 3, nowhere);
  // Cycles that the build does not reach.
  const std::string late = folder.path("late.fst");
  expect_error(run(rtl({"--wave", "900000000:", "--wave-file", late})), 2, "begins after");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(CliRtl, MachinesThatWereNotBuiltAreNamed) {
  SKIP_WITHOUT_RTL();
  expect_error(run(rtl({"--config", "fasttree-2"})), 2, "paper-*");
  expect_error(run(rtl({"--set", "paper.morton_code_units=3"})), 2,
               "paper.morton_code_units = 4, not 3");
  expect_error(run(rtl({"--max-cycles", "10"})), 4, "in stage scene_bound");
}

TEST(CliDiff, AllThreeAreTheSame) {
  SKIP_WITHOUT_RTL();
  const RunResult text = run({"diff", kScene});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_NE(text.out.find("no difference"), std::string::npos) << text.out;
  EXPECT_EQ(text.out.find("differs"), std::string::npos) << text.out;

  const json all = run_json({"diff", kScene});
  EXPECT_TRUE(all["difference"].is_null());
  EXPECT_EQ(all["config"], "paper-fpga");
  EXPECT_EQ(all["source"], kScene);
  const json simulated = run_json(rtl());
  std::vector<std::string> stages;
  for (const json& array : all["arrays"]) {
    EXPECT_EQ(array["same"], true) << array["array"];
    EXPECT_FALSE(array.contains("first_word"));
    EXPECT_NE(text.out.find(array["array"].get<std::string>()), std::string::npos);
    if (stages.empty() || stages.back() != array["stage"]) stages.push_back(array["stage"]);
    if (array["stage"] == "radix_sort") {
      EXPECT_EQ(array["words"], simulated["references"]);
    } else if (array["stage"] == "leaf_node") {
      EXPECT_EQ(array["words"], simulated["leaves"]);
    }
  }
  EXPECT_EQ(stages,
            (std::vector<std::string>{"scene_bound", "morton_code", "radix_sort", "leaf_node",
                                      "internal_node", "bit_encoding", "path_compression"}));

  // The cycles are those of simulate, stage by stage and in all.
  const json& cycles = all["cycles"];
  ASSERT_EQ(cycles.size(), simulated["stages"].size() + 1);
  for (std::size_t s = 0; s < simulated["stages"].size(); ++s) {
    EXPECT_EQ(cycles[s]["stage"], simulated["stages"][s]["stage"]);
    EXPECT_EQ(cycles[s]["rtl_cycles"], simulated["stages"][s]["cycles"]);
  }
  const json& sum = cycles.back();
  EXPECT_EQ(sum["stage"], "all");
  EXPECT_EQ(sum["rtl_cycles"], simulated["cycles"]);
  EXPECT_GT(sum["model_cycles"], 0);
  EXPECT_LT(std::abs(sum["model_off_percent"].get<double>()), 3);
  EXPECT_NE(text.out.find("model off by, %"), std::string::npos) << text.out;
}

TEST(CliDiff, AStageAndAnEngineAlone) {
  const Folder folder;
  const RunResult result =
      run({"diff", kScene, "--stage", "radix_sort", "--engine", "model", "--config", "paper-asic65",
           "--set", "paper.axes=longest", "--json", folder.path("d.json")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("sorted_codes"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("leaf_codes"), std::string::npos) << result.out;
  const json sort = json::parse(read_file(folder.path("d.json")));
  ASSERT_EQ(sort["arrays"].size(), 2u);
  EXPECT_EQ(sort["arrays"][1]["array"], "sorted_ids");
  ASSERT_EQ(sort["cycles"].size(), 1u);
  EXPECT_GT(sort["cycles"][0]["model_cycles"], 0);
  EXPECT_FALSE(sort["cycles"][0].contains("rtl_cycles"));
  EXPECT_GT(sort["arrays"][1]["words"], 100);
}

TEST(CliDiff, WrongUsageIsAnsweredWithTheRightOne) {
  expect_error(run({"diff"}), 2, "SCENE is required");
  expect_error(run({"diff", kScene, "--stage", "radixsort"}), 2, "did you mean radix_sort");
  expect_error(run({"diff", kScene, "--engine", "modle"}), 2, "did you mean model");
  expect_error(run({"diff", kScene, "--config", "fasttree-2"}), 2, "simulate --verify");
  expect_error(run({"diff", kScene, "--set", "paper.axs=cyclic"}), 2, "did you mean 'axes'");
  expect_error(run({"diff", "/no/such/scene.ply"}), 3, "/no/such/scene.ply");
}

}  // namespace
}  // namespace fasttree::cli
