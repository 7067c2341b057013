// SPDX-License-Identifier: Apache-2.0
// fasttree reproduce.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

using nlohmann::json;

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(CliReproduce, TableOneIsOfTheSynthesisReports) {
  const Folder folder;
  const RunResult text = run({"reproduce", "table1", "--csv", folder.path("t.csv")});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  const json all = run_json({"reproduce", "table1"});
  EXPECT_EQ(all["table"], "table1");
  const std::vector<std::string> modules = {"SBCU", "PSU", "MCGU",  "RSU",  "LNGU", "INGU",
                                            "BEU",  "PCU", "Cache", "rest", "all"};
  ASSERT_EQ(all["rows"].size(), modules.size());
  json sum = json::object();
  for (std::size_t i = 0; i < modules.size(); ++i) {
    const json& row = all["rows"][i];
    EXPECT_EQ(row["module"], modules[i]);
    EXPECT_GT(row["lut"], 0) << row;
    EXPECT_GT(row["registers"], 0) << row;
    EXPECT_EQ(row["at_paper_clock"], row["fmax_mhz"] >= 163.0) << row;
    EXPECT_NE(text.out.find(modules[i]), std::string::npos);
    const auto far = [&](const char* ours, const char* paper) {
      return std::abs(row[ours].get<double>() / row[paper].get<double>() - 1) > 0.25;
    };
    if (far("lut", "paper_lut") || far("registers", "paper_registers")) {
      const std::string reason = row["reason"];
      EXPECT_NE(reason, "") << row;
      EXPECT_NE(text.out.find(reason), std::string::npos);
    }
    if (modules[i] == "all") continue;
    for (const char* key : {"lut", "registers", "bram_kbits", "dsp", "gate_equivalents"}) {
      sum[key] = sum.value(key, 0.0) + row[key].get<double>();
    }
  }
  // Rows of the paper, and ours: the last one has all the others.
  EXPECT_EQ(all["rows"][0]["paper_lut"], 2485);
  EXPECT_EQ(all["rows"][8]["paper_bram_kbits"], 172);
  const json& whole = all["rows"].back();
  EXPECT_EQ(whole["paper_lut"], 173391);
  for (const auto& [key, value] : sum.items()) {
    EXPECT_NEAR(whole[key].get<double>(), value.get<double>(), 1e-6 * value.get<double>()) << key;
  }
  EXPECT_EQ(all["within_paper"],
            whole["lut"] <= whole["paper_lut"] && whole["registers"] <= whole["paper_registers"]);
  const std::string csv = read_file(folder.path("t.csv"));
  EXPECT_EQ(csv.rfind("module,", 0), 0u);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 12);
}

TEST(CliReproduce, TableOneOfTheDocumentationIsThePresentOne) {
  const std::string page = read_file(FASTTREE_SOURCES "/docs/accelerator/synthesis.md");
  const std::string text = run({"reproduce", "table1"}).out;
  const std::string table = text.substr(0, text.find("\n\n"));
  EXPECT_NE(table.find("MCGU"), std::string::npos);
  EXPECT_NE(page.find("```\n" + table + "\n```"), std::string::npos)
      << "docs/accelerator/synthesis.md has to show:\n"
      << table;
}

TEST(CliReproduce, TableTwoOfASubstituteUnderItsOwnName) {
  const Folder folder;
  // Called as a scene of the paper, but of another size.
  write_file(folder.path("bunny.obj"), kTriangle);
  const json all =
      run_json({"reproduce", "table2", "--scenes", folder.path(""), "--scene", "scene:knot:2000"});
  ASSERT_EQ(all["rows"].size(), 6u);
  for (const json& row : all["rows"]) {
    EXPECT_TRUE(row["scene"] == "bunny" || row["scene"] == all["rows"][3]["scene"]);
    EXPECT_NE(row["scene"], "Bunny");
    EXPECT_TRUE(row["paper_time_ms"].is_null());
    EXPECT_TRUE(row["ratio"].is_null());
    EXPECT_GT(row["time_ms"], 0);
    EXPECT_NE(row["reason"], "");
  }
  // The paper's way: the same cycles at another clock.
  const json &fpga = all["rows"][3], &scaled = all["rows"][4], &timed = all["rows"][5];
  EXPECT_EQ(fpga["cycles_per_triangle"], scaled["cycles_per_triangle"]);
  EXPECT_NEAR(scaled["time_ms"], fpga["time_ms"].get<double>() * 163 / 500, 1e-12);
  EXPECT_EQ(timed["how"], "paper-asic65");
  EXPECT_NE(timed["cycles_per_triangle"], fpga["cycles_per_triangle"]);
  EXPECT_EQ(all["skipped"].size(), 6u);
}

TEST(CliReproduce, TableTwoOfTheBunny) {
  const std::string bunny = real_scene("bunny.ply");
  if (bunny.empty()) GTEST_SKIP() << "bunny.ply is not here";
  const Folder folder;
  const std::vector<std::string> arguments = {"reproduce", "table2", "--scene",
                                              bunny,       "--csv",  folder.path("t.csv")};
  const json all = run_json(arguments);
  ASSERT_EQ(all["rows"].size(), 3u);
  const std::vector<double> paper = {15.6, 5.1, 5.1};
  for (std::size_t i = 0; i < 3; ++i) {
    const json& row = all["rows"][i];
    EXPECT_EQ(row["scene"], "Bunny");
    EXPECT_EQ(row["paper_time_ms"], paper[i]);
    EXPECT_NEAR(row["ratio"], row["time_ms"].get<double>() / paper[i], 1e-9);
  }
  EXPECT_NEAR(all["rows"][0]["paper_cycles_per_triangle"], 36.6, 0.05);
  EXPECT_EQ(all["skipped"].size(), 5u);
  const std::string csv = read_file(folder.path("t.csv"));
  EXPECT_EQ(csv.rfind("scene,", 0), 0u);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  // A check that can fail.
  std::vector<std::string> strict = arguments;
  strict.insert(strict.end(), {"--within", "0"});
  EXPECT_EQ(run(strict).exit_code, 1);
  strict.back() = "900";
  EXPECT_EQ(run(strict).exit_code, 0);
}

TEST(CliReproduce, TableThreeHasTheLibraryBesideTheMachines) {
  const json all = run_json({"reproduce", "table3", "--scene", "scene:knot:2000", "--repeat", "2"});
  ASSERT_EQ(all["paper"].size(), 6u);
  EXPECT_EQ(all["paper"][3]["work"], "RayCore");
  std::map<std::string, json> rows;
  for (const json& row : all["rows"]) rows[row["figure"]] = row;
  for (const char* machine : {"paper-asic65", "paper-asic28", "fasttree-2"}) {
    ASSERT_TRUE(rows.contains(machine)) << machine;
    EXPECT_GT(rows[machine]["time_ms"], 0);
  }
  EXPECT_EQ(rows["paper-asic65"]["area_mm2"], "5.40");
  EXPECT_EQ(rows["paper-asic28"]["area_mm2"], "1.40");
  EXPECT_EQ(rows["paper-asic28"]["time_ms"], rows["paper-asic65"]["time_ms"]);
  for (const char* profile : {"paper", "realtime"}) {
    const json& row = rows.at("library, profile " + std::string(profile));
    EXPECT_GT(row["time_ms"], 0);
    EXPECT_TRUE(row["cycles_per_triangle"].is_null());
  }
  EXPECT_EQ(all["skipped"], json({"bunny"}));
}

TEST(CliReproduce, WrongUsageIsAnsweredWithTheRightOne) {
  const Folder folder;
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    const char* part;
  };
  const std::vector<Case> cases = {
      {{"reproduce"}, 2, "TABLE"},
      {{"reproduce", "table4", "--scene", "scene:knot:100"}, 2, "table2"},
      {{"reproduce", "table1", "--scene", "scene:knot:100"}, 2, "table2"},
      {{"reproduce", "table1", "--within", "5"}, 2, "table2"},
      {{"reproduce", "table2"}, 2, "--scenes"},
      {{"reproduce", "table2", "--scenes", folder.path("nothing")}, 3, "nothing"},
      {{"reproduce", "table2", "--scenes", folder.path("")}, 3, "no meshes"}};
  for (const Case& c : cases) {
    const RunResult result = run(c.arguments);
    EXPECT_EQ(result.exit_code, c.exit_code) << result.err;
    EXPECT_NE(result.err.find(c.part), std::string::npos) << result.err << "lacks: " << c.part;
  }
}

}  // namespace
}  // namespace fasttree::cli
