// SPDX-License-Identifier: Apache-2.0
// fasttree build: what scripts rely on.
#include <gtest/gtest.h>

#include <string>

#include "runner.h"

namespace fasttree::cli {
namespace {

TEST(CliBuild, HasTheKeysThatScriptsRead) {
  const auto json =
      run_json({"build", "scene:knot:5000", "--profile", "paper", "--axes", "cyclic"});
  for (const char* key : {"triangles", "depth", "references", "leaves", "nodes", "build_ms"}) {
    EXPECT_TRUE(json.contains(key) && json[key].is_number()) << key;
  }
  EXPECT_EQ(json["tree_hash"].get<std::string>().size(), 16u);
  EXPECT_GE(json["references"], json["triangles"]);
  EXPECT_EQ(json["nodes"].get<std::uint64_t>(), 2 * json["leaves"].get<std::uint64_t>() - 1);
}

TEST(CliBuild, TreesDoNotDependOnThreadsOrSimdOrImplementation) {
  const std::vector<std::vector<std::string>> trees = {{"--profile", "paper", "--axes", "cyclic"},
                                                       {"--profile", "paper", "--axes", "longest"},
                                                       {"--profile", "realtime"}};
  for (const std::vector<std::string>& which : trees) {
    const std::string& axes = which.back();
    const auto build = [&](std::vector<std::string> more) {
      std::vector<std::string> arguments = {"build", "scene:stadium:20000"};
      arguments.insert(arguments.end(), which.begin(), which.end());
      arguments.insert(arguments.end(), more.begin(), more.end());
      return run_json(arguments)["tree_hash"].get<std::string>();
    };
    const std::string hash = build({"--threads", "1"});
    EXPECT_EQ(build({"--threads", "2"}), hash) << axes;
    EXPECT_EQ(build({"--threads", "7"}), hash) << axes;
    EXPECT_EQ(build({"--simd", "scalar"}), hash) << axes;
    EXPECT_EQ(build({"--simd", "widest"}), hash) << axes;
    EXPECT_EQ(build({"--implementation", "reference"}), hash) << axes;
    EXPECT_EQ(build({"--repeat", "3"}), hash) << axes;
  }
}

TEST(CliBuild, DepthIsHonoured) {
  const auto json = run_json({"build", "scene:knot:5000", "--profile", "paper", "--depth", "9"});
  EXPECT_EQ(json["depth"], 9);
  const auto automatic =
      run_json({"build", "scene:knot:5000", "--profile", "paper", "--depth", "auto"});
  EXPECT_NE(automatic["depth"], 9);
  EXPECT_NE(automatic["tree_hash"], json["tree_hash"]);
}

TEST(CliBuild, JsonOnStandardOutputIsAlone) {
  const RunResult result = run({"build", "scene:knot:2000", "--json", "-"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NO_THROW(result.json());
  EXPECT_EQ(result.err, "");  // no progress bar in a pipe
}

TEST(CliBuild, JsonInAFileComesWithText) {
  const Folder folder;
  const RunResult result =
      run({"build", "scene:knot:2000", "--repeat", "3", "--json", folder.path("a.json")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("hash"), std::string::npos);
  const auto json = nlohmann::json::parse(read_file(folder.path("a.json")));
  EXPECT_EQ(json["build_ms_all"].size(), 3u);
  EXPECT_EQ(folder.file_count(), 1u);  // no temporary file stays
}

TEST(CliBuild, QuietSaysNothing) {
  const RunResult result = run({"build", "scene:knot:2000", "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "");
}

TEST(CliBuild, EveryProfileBuilds) {
  for (const char* profile : {"realtime", "paper", "sah-exact", "sah-binned"}) {
    const auto json = run_json({"build", "scene:knot:3000", "--profile", profile});
    EXPECT_EQ(json["profile"], profile);
    EXPECT_GT(json["quality"]["sah_cost"], 0.0);
  }
}

TEST(CliBuild, ASavedTreeHasTheSameHash) {
  const Folder folder;
  const auto json = run_json({"build", "scene:knot:3000", "--out", folder.path("t.ft")});
  const auto info = run_json({"info", folder.path("t.ft")});
  EXPECT_EQ(info["tree"]["tree_hash"], json["tree_hash"]);
  EXPECT_EQ(info["tree"]["triangles"], json["triangles"]);
  EXPECT_EQ(info["quality"]["leaves"], json["leaves"]);
}

TEST(CliBuild, AnEmptyMeshHasATree) {
  const Folder folder;
  write_file(folder.path("empty.ply"),
             "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
             "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
             "end_header\n");
  const RunResult result = run({"build", folder.path("empty.ply"), "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.json()["nodes"], 1);
  EXPECT_EQ(result.json()["references"], 0);
}

}  // namespace
}  // namespace fasttree::cli
