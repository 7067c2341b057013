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

  const RunResult run_there = run({"build", path, "--device", device, "--json", "-"});
  ASSERT_EQ(run_there.exit_code, 0) << run_there.err;
  const auto there = run_there.json();
  std::vector<std::string> here = {"build", path, "--profile", there["profile"]};
  if (there["profile"] == "paper") {
    here.insert(here.end(),
                {"--axes", there["axes"], "--depth", std::to_string(there["depth"].get<int>())});
  }
  EXPECT_EQ(run_json(here)["tree_hash"], there["tree_hash"]);
  // The engines that take minutes have built it once; that is enough.
  if (std::string(engine) == "rtl") return;
  const auto verified = run_json({"verify", path, "--device", device, "--rays", "1100"});
  EXPECT_EQ(verified["ok"], true);
  EXPECT_EQ(verified["tree_hash"], there["tree_hash"]);
  Folder folder;
  const auto drawn = run_json({"render", path, "--device", device, "--size", "160x120", "--out",
                               folder.path("picture.png")});
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
