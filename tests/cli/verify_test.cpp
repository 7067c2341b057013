// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "fasttree/build.h"
#include "fasttree/tree_file.h"
#include "runner.h"

namespace fasttree::cli {
namespace {

TEST(CliVerify, PassesRightTrees) {
  for (const char* scene : {"scene:knot:2000", "scene:stadium:2000", "scene:hall:2000"}) {
    for (const char* axes : {"cyclic", "longest"}) {
      const auto json = run_json({"verify", scene, "--profile", "paper", "--axes", axes, "--rays",
                                  "2200", "--oracle", "brute"});
      EXPECT_EQ(json["ok"], true);
      EXPECT_EQ(json["rays"]["rays"], 2200);
      EXPECT_EQ(json["rays"]["brute_force_checked"], 2200);
      EXPECT_GT(json["rays"]["hits"], 200);
      EXPECT_EQ(json["bytes"]["ok"], true);
    }
  }
}

TEST(CliVerify, PassesTheDefaultProfile) {
  const auto json = run_json({"verify", "scene:hall:2000", "--rays", "2200", "--oracle", "brute"});
  EXPECT_EQ(json["profile"], "realtime");
  EXPECT_EQ(json["ok"], true);
  EXPECT_EQ(json["bytes"]["ok"], true);
}

TEST(CliVerify, PassesTheBaselines) {
  for (const char* profile : {"sah-exact", "sah-binned"}) {
    const auto json = run_json({"verify", "scene:knot:2000", "--profile", profile});
    EXPECT_EQ(json["ok"], true);
    EXPECT_FALSE(json.contains("bytes"));
  }
}

TEST(CliVerify, PassesWithEmbreeWhereItIsThere) {
  if (run_json({"info"})["embree"].is_null()) GTEST_SKIP() << "built without Embree";
  const auto json =
      run_json({"verify", "scene:knot:20000", "--rays", "11000", "--oracle", "embree"});
  EXPECT_EQ(json["rays"]["oracle"], "embree");
  EXPECT_EQ(json["rays"]["wrong"], 0);
}

TEST(CliVerify, PassesATreeFileWithItsMesh) {
  const Folder folder;
  const std::string tree = folder.path("t.ft");
  ASSERT_EQ(
      run({"build", "scene:knot:2000", "--profile", "paper", "--axes", "longest", "--out", tree})
          .exit_code,
      0);
  EXPECT_EQ(run_json({"verify", tree})["ok"], true);
  const auto json = run_json({"verify", tree, "--mesh", "scene:knot:2000"});
  EXPECT_EQ(json["axes"], "longest");
  EXPECT_EQ(json["bytes"]["ok"], true);
}

TEST(CliVerify, RefusesATreeWithAnotherMesh) {
  const Folder folder;
  const std::string tree = folder.path("t.ft");
  ASSERT_EQ(run({"build", "scene:wave:2000:0", "--out", tree}).exit_code, 0);
  const RunResult result = run({"verify", tree, "--mesh", "scene:wave:2000:7"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("fasttree: error: "), std::string::npos) << result.err;
}

TEST(CliVerify, FailsForATreeThatBreaksAnInvariant) {
  const Folder folder;
  const std::string tree = folder.path("t.ft");
  // Well-formed as a file, but the root's upper child is the root.
  const TreeInfo info;
  const Tree broken(info, {Node::inner(0, 0.0f, 0), Node::leaf(0, 0), Node::leaf(0, 0)}, {});
  ASSERT_TRUE(save_tree(broken, tree).ok());
  const RunResult result = run({"verify", tree, "--json", "-"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.json()["ok"], false);
  EXPECT_FALSE(result.json()["invariants"]["broken"].get<std::string>().empty());
  EXPECT_EQ(run({"info", tree}).exit_code, 3);
}

TEST(CliVerify, RefusesADamagedTreeFile) {
  const Folder folder;
  const std::string tree = folder.path("t.ft");
  ASSERT_EQ(run({"build", "scene:knot:2000", "--out", tree}).exit_code, 0);
  std::string bytes = read_file(tree);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_file(tree, bytes);
  EXPECT_EQ(run({"verify", tree}).exit_code, 3);
  write_file(tree, bytes.substr(0, bytes.size() / 2));
  EXPECT_EQ(run({"verify", tree}).exit_code, 3);
}

TEST(CliVerify, SeedsChangeTheRays) {
  const auto a = run_json({"verify", "scene:knot:500", "--seed", "1"})["rays"]["hits"];
  const auto b = run_json({"verify", "scene:knot:500", "--seed", "2"})["rays"]["hits"];
  EXPECT_NE(a, b);
  EXPECT_EQ(run_json({"verify", "scene:knot:500", "--seed", "1"})["rays"]["hits"], a);
}

}  // namespace
}  // namespace fasttree::cli
