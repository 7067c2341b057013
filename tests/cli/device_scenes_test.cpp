// SPDX-License-Identifier: Apache-2.0
// The real scenes over the network: the tree that comes back is the one that is built here, passes
// the verifier and can be drawn.
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

class DeviceScene : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(DeviceScene, ComesBackVerifiedAndDrawn) {
  const auto [name, engine] = GetParam();
  const std::string path = real_scene(name);
  if (path.empty()) GTEST_SKIP() << name << " is not on this machine";
  const bool library = std::string(engine) == "library";
  std::vector<std::string> serve = {"serve", "--listen", "127.0.0.1:0", "--engine", engine};
  if (!library) serve.insert(serve.end(), {"--config", "paper-fpga"});
  Background server(serve);
  if (!server.read_until("scenes") && std::string(engine) == "rtl" && server.wait() == 2) {
    GTEST_SKIP() << "no RTL was built";
  }
  ASSERT_NE(server.word_after("scenes"), "") << server.out();
  const std::string device = "udp://" + server.word_after("listening");

  Folder folder;
  const std::string file = folder.path("tree.ft");
  const auto there = run_json({"build", path, "--device", device, "--out", file});
  std::vector<std::string> here = {"build", path, "--profile", there["profile"]};
  if (there["profile"] == "paper") {
    here.insert(here.end(),
                {"--axes", there["axes"], "--depth", std::to_string(there["depth"].get<int>())});
  }
  EXPECT_EQ(run_json(here)["tree_hash"], there["tree_hash"]);
  // An engine that takes long builds it once; the others for each command.
  std::vector<std::string> tree = {path, "--device", device};
  if (std::string(engine) == "rtl") tree = {file, "--mesh", path};
  const auto with_tree = [&](const char* command, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {command};
    arguments.insert(arguments.end(), tree.begin(), tree.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_json(arguments);
  };
  const auto verified = with_tree("verify", {"--rays", "1100"});
  EXPECT_EQ(verified["ok"], true);
  EXPECT_EQ(verified["tree_hash"], there["tree_hash"]);
  const auto drawn =
      with_tree("render", {"--size", "160x120", "--out", folder.path("picture.png")});
  EXPECT_GT(drawn["primary"]["rays"], 0);
}

INSTANTIATE_TEST_SUITE_P(Shared, DeviceScene,
                         testing::Values(std::tuple{"bunny.ply", "library"},
                                         std::tuple{"bunny.ply", "model"},
                                         std::tuple{"bunny.ply", "rtl"},
                                         std::tuple{"dragon.ply", "library"},
                                         std::tuple{"dragon.ply", "model"}));

}  // namespace
}  // namespace fasttree::cli
