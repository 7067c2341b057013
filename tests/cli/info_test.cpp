// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

TEST(CliInfo, ListsProceduralScenesThatLoad) {
  const auto scenes = run_json({"info", "--list"})["scenes"];
  EXPECT_GE(scenes.size(), 5u);
  for (const auto& scene : scenes) {
    const std::string name = scene["name"];
    const auto json = run_json({"info", name + ":2000"});
    EXPECT_GT(json["scene"]["triangles"], 0) << name;
  }
}

TEST(CliInfo, CountsAgreeWithBuild) {
  const auto info = run_json({"info", "scene:stadium:10000"});
  for (const char* axes : {"cyclic", "longest"}) {
    const auto build =
        run_json({"build", "scene:stadium:10000", "--profile", "paper", "--axes", axes});
    const std::size_t depth = build["depth"];
    EXPECT_EQ(info[axes]["depth"], depth) << axes;
    EXPECT_EQ(info[axes]["references_by_depth"][depth], build["references"]) << axes;
    EXPECT_EQ(info[axes]["references_by_depth"][0], build["triangles"]) << axes;
    EXPECT_EQ(info[axes]["bits"], build["bits"]) << axes;
  }
}

TEST(CliInfo, AFlatSceneHasADeadAxis) {
  const Folder folder;
  write_file(folder.path("flat.obj"), "v 0 0 1\nv 4 0 1\nv 0 4 1\nf 1 2 3\n");
  const auto json = run_json({"info", folder.path("flat.obj")});
  EXPECT_EQ(json["scene"]["live_axes"], (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(json["scene"]["triangles"], 1);
}

TEST(CliInfo, PrintsAConfigurationThatIsOne) {
  const Folder folder;
  const RunResult printed = run({"info", "--config", "paper-fpga"});
  EXPECT_EQ(printed.exit_code, 0);
  write_file(folder.path("copy.toml"), printed.out);
  EXPECT_EQ(run({"info", "--config", folder.path("copy.toml")}).out, printed.out);
  EXPECT_EQ(run({"info", "--config", "paper-fgpa"}).exit_code, 3);
}

TEST(CliInfo, DescribesTheProgram) {
  const auto json = run_json({"info"});
  EXPECT_EQ(json["program"], "fasttree");
  EXPECT_FALSE(json["simd_targets"].empty());
  EXPECT_TRUE(json.contains("embree"));
  const RunResult version = run({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out, "fasttree " + json["version"].get<std::string>() + "\n");
}

TEST(CliInfo, HelpHasAnExampleEverywhere) {
  for (const char* command : {"info", "build", "verify", "render", "compare", "animate", "view",
                              "memory", "simulate", "diff", "explore", "reproduce"}) {
    const RunResult result = run({command, "--help"});
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_NE(result.out.find(std::string("Example:\n  fasttree ") + command), std::string::npos)
        << command;
    EXPECT_NE(result.out.find("--json"), std::string::npos) << command;
    EXPECT_NE(result.out.find("--threads"), std::string::npos) << command;
  }
  EXPECT_NE(run({"--help"}).out.find("Example:"), std::string::npos);
}

}  // namespace
}  // namespace fasttree::cli
