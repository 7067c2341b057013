// SPDX-License-Identifier: Apache-2.0
// fasttree reproduce all: the page, and the same figures as JSON and CSV.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::vector<std::string> quick(const std::string& out, const std::string& scene) {
  return {"reproduce", "all", "--quick", "--scene", "scene:knot:500",
          "--scene",   scene, "--out",   out};
}

/// Without the lines that say of themselves that they were measured.
std::string not_measured(const std::string& page) {
  std::istringstream lines(page);
  std::string rest;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("data-measured") == std::string::npos) rest += line + "\n";
  }
  return rest;
}

/// Without what was measured: whole objects say so of themselves.
json not_measured(const json& value) {
  if (value.is_object() && value.value("measured", false)) return nullptr;
  if (!value.is_structured()) return value;
  json rest = value;
  for (json& part : rest) part = not_measured(part);
  return rest;
}

TEST(CliReproduceAll, PageJsonAndTablesAgreeAndStayTheSame) {
  const Folder folder;
  const std::string scene = folder.path("<i>&amp;.obj"), first = folder.path("a/deep"),
                    second = folder.path("b");
  write_file(scene, kTriangle);
  // A scene that there is nothing to say of is left out, and named.
  const std::string empty = folder.path("empty.ply");
  write_file(empty,
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0\n1 0 0\n0 1 0\n");
  std::vector<std::string> arguments = quick(first, scene);
  arguments.insert(arguments.end(), {"--scene", empty});
  const json all = run_json(arguments);

  // What it is, and that nothing of it is the paper's.
  ASSERT_EQ(all["scenes"].size(), 2u);
  EXPECT_EQ(all["scenes"][1]["scene"], "<i>&amp;");
  ASSERT_EQ(all["missing"].size(), 7u);
  EXPECT_EQ(all["missing"][0]["scene"], "empty");
  EXPECT_EQ(all["missing"][0]["reason"], "it has no triangles");
  for (const json& one : all["scenes"]) {
    EXPECT_EQ(one["same_tree"], true);
    EXPECT_EQ(one["of_paper"], false);
    ASSERT_EQ(one["machines"].size(), 4u);
    for (const json& machine : one["machines"]) {
      EXPECT_EQ(machine["tree_hash"], one["tree_hash"]);
      std::uint64_t cycles = 0;
      for (const json& stage : machine["stages"]) cycles += stage["cycles"].get<std::uint64_t>();
      EXPECT_EQ(cycles, machine["cycles"]);
    }
  }
  EXPECT_EQ(all["table1"].size(), 11u);
  EXPECT_EQ(all["table2"].size(), 6u);
  EXPECT_EQ(all["table3"].size(), 10u);
  ASSERT_EQ(all["figure1"].size(), 10u);
  for (const json& row : all["figure1"]) {
    EXPECT_NEAR(row["frame_ms"],
                row["tree_ms"].get<double>() + row["layout_ms"].get<double>() +
                    row["trace_ms"].get<double>(),
                1e-9);
  }
  // In an accelerator's row the tree's time is the accelerator's.
  EXPECT_EQ(all["figure1"][3]["builder"], "paper-asic65");
  EXPECT_EQ(all["figure1"][3]["tree_ms"], all["scenes"][0]["machines"][1]["time_ms"]);
  ASSERT_EQ(all["sensitivity"].size(), 2u);
  for (const json& machine : all["sensitivity"]) {
    EXPECT_GT(machine["changes"].size(), 40u);
    for (const json& change : machine["changes"]) EXPECT_NE(change["meaning"], "");
  }

  // The files beside the page hold the same.
  EXPECT_EQ(json::parse(read_file(first + "/report.json")), all);
  const std::string table2 = read_file(first + "/table2.csv");
  EXPECT_EQ(std::count(table2.begin(), table2.end(), '\n'), 7);
  std::size_t tables = 0;
  for (const auto& entry : fs::directory_iterator(first)) {
    if (entry.path().extension() == ".csv") ++tables;
    EXPECT_GT(fs::file_size(entry.path()), 20u) << entry.path();
  }
  EXPECT_EQ(tables, 13u);
  const std::string page = read_file(first + "/report.html");
  EXPECT_EQ(page.find("<i>"), std::string::npos) << "a name became a tag";
  EXPECT_NE(page.find("&lt;i&gt;&amp;amp;"), std::string::npos);
  for (const char* missing : {"Bunny", "Fairy forest", "Happy Buddha"}) {
    EXPECT_NE(page.find(missing), std::string::npos);
  }

  // Once more: but for what was measured, the same to the byte.
  std::replace(arguments.begin(), arguments.end(), first, second);
  const RunResult again = run(arguments);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("missing: Conference"), std::string::npos) << again.out;
  const std::string page_again = read_file(second + "/report.html");
  EXPECT_EQ(not_measured(page), not_measured(page_again));
  EXPECT_NE(page, page_again) << "no time was measured";
  EXPECT_EQ(not_measured(json::parse(read_file(second + "/report.json"))), not_measured(all));
  for (const char* table : {"scenes", "table2", "machines", "stages", "bandwidth", "text"}) {
    const std::string name = "/" + std::string(table) + ".csv";
    EXPECT_EQ(read_file(first + name), read_file(second + name)) << name;
  }
}

TEST(CliReproduceAll, TooLittleMemoryIsFourAndLeavesNoPage) {
  const Folder folder;
  const std::string out = folder.path("out");
  std::vector<std::string> arguments = quick(out, "scene:knot:400");
  arguments.insert(arguments.end(), {"--memory-limit", "1M"});
  EXPECT_EQ(run(arguments).exit_code, 4);
  EXPECT_TRUE(fs::is_empty(out));
}

TEST(CliReproduceAll, WrongUsageAndUnwritableFolders) {
  const Folder folder;
  write_file(folder.path("file"), "");
  write_file(folder.path("broken.obj"), "v 0 0 0\nf 1 2 3\n");
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    const char* part;
  };
  const std::vector<Case> cases = {
      {{"reproduce", "al"}, 2, "did you mean all"},
      {{"reproduce", "all", "--csv", "t.csv"}, 2, "--out"},
      {{"reproduce", "table2", "--quick"}, 2, "for all"},
      {{"reproduce", "table1", "--out", "x"}, 2, "for all"},
      {{"reproduce", "all", "--quik"}, 2, "did you mean --quick"},
      {{"reproduce", "all", "--scenes", folder.path("nothing")}, 3, "nothing"},
      {{"reproduce", "all", "--quick", "--scene", folder.path("broken.obj"), "--out",
        folder.path("o")},
       3,
       "broken.obj"},
      {{"reproduce", "all", "--quick", "--out", folder.path("file") + "/in"}, 3, "--out"},
      {{"reproduce", "all", "--quick", "--out", folder.path("file")}, 3, "file"}};
  for (const Case& c : cases) {
    const RunResult result = run(c.arguments);
    EXPECT_EQ(result.exit_code, c.exit_code) << result.err;
    EXPECT_NE(result.err.find(c.part), std::string::npos) << result.err << "lacks: " << c.part;
  }
}

TEST(CliReproduceAll, CanBeCancelledAndLeavesNothing) {
  const Folder folder;
  RunSettings settings;
  settings.meanwhile = [](int pid) { kill(pid, SIGINT); };
  const RunResult result = run(
      {"reproduce", "all", "--scene", "scene:knot:200k", "--out", folder.path("out")}, settings);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_TRUE(fs::is_empty(folder.path("out")));
}

}  // namespace
}  // namespace fasttree::cli
