// SPDX-License-Identifier: Apache-2.0
// fasttree serve, and build, verify and render with --device, as separate processes; and what
// happens when one of them is killed.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A server on a port of its own.
class Served {
 public:
  explicit Served(std::vector<std::string> more, const std::string& listen = "127.0.0.1:0")
      : program_(arguments(std::move(more), listen)) {
    if (!program_.read_until("scenes")) throw std::runtime_error("no server: " + program_.out());
    address_ = program_.word_after("listening");
  }
  std::string address() const { return address_; }
  std::string device() const { return "udp://" + address_; }
  Background& program() { return program_; }

 private:
  static std::vector<std::string> arguments(std::vector<std::string> more,
                                            const std::string& listen) {
    std::vector<std::string> all = {"serve", "--listen", listen};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Background program_;
  std::string address_;
};

constexpr const char* kScene = "scene:knot:2k";

TEST(Serve, ATreeBuiltThereIsTheTreeBuiltHere) {
  Served server({"--engine", "library"});
  for (const char* profile : {"realtime", "paper", "sah-binned"}) {
    const auto here = run_json({"build", kScene, "--profile", profile});
    const auto there =
        run_json({"build", kScene, "--profile", profile, "--device", server.device()});
    EXPECT_EQ(there["tree_hash"], here["tree_hash"]);
    EXPECT_EQ(there["nodes"], here["nodes"]);
    EXPECT_EQ(there["device"]["engine"], "library");
    EXPECT_EQ(there["device"]["cycles"], nullptr);
    EXPECT_GT(there["device"]["build_ms"], 0);
    EXPECT_GT(there["device"]["total_ms"], there["device"]["build_ms"]);
    EXPECT_GE(there["device"]["link"]["data_bytes_sent"], 36 * here["triangles"].get<int>());
  }
  server.program().signal(SIGINT);
  EXPECT_EQ(server.program().wait(), 0);
  EXPECT_NE(server.program().out().find("3 sessions"), std::string::npos) << server.program().out();
}

TEST(Serve, AMachineBuildsAndIsVerifiedAndRendered) {
  Folder folder;
  Served server({"--engine", "model", "--config", "paper-fpga", "--sessions", "3", "--json",
                 folder.path("server.json")});
  const auto alone = run_json({"simulate", kScene, "--config", "paper-fpga"});
  const auto built = run_json({"build", kScene, "--device", server.device()});
  EXPECT_EQ(built["tree_hash"], alone["tree_hash"]);
  EXPECT_EQ(built["device"]["cycles"], alone["cycles"]);
  EXPECT_EQ(built["device"]["config"], "paper-fpga");
  EXPECT_FALSE(built["device"]["stages"].empty());
  const auto verified = run_json({"verify", kScene, "--device", server.device(), "--rays", "500"});
  EXPECT_EQ(verified["ok"], true);
  EXPECT_EQ(verified["bytes"]["ok"], true);
  EXPECT_EQ(verified["tree_hash"], alone["tree_hash"]);
  const auto rendered = run_json({"render", kScene, "--device", server.device(), "--size", "64x48",
                                  "--out", folder.path("knot.png")});
  EXPECT_EQ(rendered["device"]["engine"], "model");
  EXPECT_GT(read_file(folder.path("knot.png")).size(), 500u);
  EXPECT_EQ(server.program().wait(), 0);
  const auto figures = nlohmann::json::parse(read_file(folder.path("server.json")));
  EXPECT_EQ(figures["served"], 3);
  EXPECT_EQ(figures["failed"], 0);
}

TEST(Serve, RtlBuildsTheSame) {
  const RunResult here = run({"build", "scene:knot:300", "--device", "rtl:paper-fpga"});
  if (here.exit_code == 2) GTEST_SKIP() << here.err;
  Served server({"--engine", "rtl", "--config", "paper-fpga"});
  const auto there = run_json({"build", "scene:knot:300", "--device", server.device()});
  const auto model = run_json({"build", "scene:knot:300", "--device", "model:paper-fpga"});
  EXPECT_EQ(there["tree_hash"], model["tree_hash"]);
  EXPECT_GT(there["device"]["cycles"], 1000);
}

TEST(Serve, DevicesOfThisProcessNeedNoServer) {
  const auto here = run_json({"build", kScene});
  const auto device = run_json({"build", kScene, "--device", "library"});
  EXPECT_EQ(device["tree_hash"], here["tree_hash"]);
  EXPECT_EQ(device["device"]["link"], nullptr);
  const auto verified =
      run_json({"verify", kScene, "--device", "model:fasttree-2", "--rays", "100"});
  EXPECT_EQ(verified["ok"], true);
}

TEST(Serve, JumboFramesAreAgreedOn) {
  Served server({});
  const auto jumbo = run_json(
      {"build", "scene:knot:20k", "--device", server.device(), "--device-payload", "65448"});
  const auto ethernet = run_json({"build", "scene:knot:20k", "--device", server.device()});
  EXPECT_EQ(jumbo["tree_hash"], ethernet["tree_hash"]);
  EXPECT_LT(jumbo["device"]["link"]["frames_sent"].get<int>(),
            ethernet["device"]["link"]["frames_sent"].get<int>());
}

void expect_failure(const RunResult& result, int exit_code, const std::string& says) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
}

TEST(Serve, FailuresOfTheNetworkAreInput) {
  expect_failure(run({"build", kScene, "--device", "udp://127.0.0.1:1"}), 3,
                 "127.0.0.1:1: nothing");
  expect_failure(run({"build", kScene, "--device", "udp://no-such-host.invalid"}), 3,
                 "no such host");
  expect_failure(run({"build", kScene, "--device", "udp://a:b"}), 2, "HOST:PORT");
  expect_failure(run({"build", kScene, "--device", "model:nonsense"}), 3, "nonsense");
  expect_failure(run({"serve", "--config", "paper-fpga"}), 2, "--engine");
  expect_failure(run({"serve", "--engine", "tpu"}), 2, "library");
  expect_failure(run({"serve", "--engine", "rtl", "--config", "fasttree-2"}), 2, "RTL");
  Served server({});
  expect_failure(run({"serve", "--listen", server.address()}), 3, "cannot listen");
  Folder folder;
  run({"build", kScene, "--out", folder.path("knot.ft")});
  expect_failure(run({"verify", folder.path("knot.ft"), "--device", server.device()}), 2,
                 "is a tree");
}

TEST(Serve, ASceneOverTheLimitIsRefused) {
  Served server({"--memory-limit", "64K"});
  expect_failure(run({"build", kScene, "--device", server.device()}), 4, "--memory-limit");
}

TEST(Serve, CtrlCOfTheClientFreesTheServer) {
  Served server({"--engine", "model"});
  RunSettings interrupt;
  interrupt.meanwhile = [](int pid) {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    kill(pid, SIGINT);
  };
  const RunResult result =
      run({"build", "scene:knot:200k", "--device", server.device()}, interrupt);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  const RunResult next = run({"build", kScene, "--device", server.device(), "--device-wait", "10"});
  EXPECT_EQ(next.exit_code, 0) << next.err;
}

TEST(Serve, TheSecondOfTwoIsToldOrWaits) {
  Served server({"--engine", "model"});
  Background first(
      {"build", "scene:knot:50k", "--device", server.device(), "--device-wait", "600", "--quiet"});
  // Until it has the server.
  const auto start = Clock::now();
  RunResult second;
  do {
    second = run({"build", "scene:knot:200", "--device", server.device()});
  } while (second.exit_code == 0 && seconds_since(start) < 60);
  expect_failure(second, 3, "busy");
  const RunResult third =
      run({"build", "scene:knot:200", "--device", server.device(), "--device-wait", "600"});
  EXPECT_EQ(third.exit_code, 0) << third.err;
  EXPECT_EQ(first.wait(), 0);
}

/// How often to kill one side at a random moment. That the other ends within its time-out is tested
/// to the microsecond where time is simulated (device/link/endurance_test.cpp).
int kills() {
  const char* asked = std::getenv("FASTTREE_DEVICE_PROCESS_KILLS");
  return asked != nullptr ? std::atoi(asked) : 6;
}

constexpr double kTimeout = 0.5;  // of silence, for both sides

TEST(Serve, AKilledServerEndsItsClient) {
  std::mt19937 random(1);
  Served first({"--engine", "model", "--timeout", std::to_string(kTimeout)});
  const std::string address = first.address(), device = first.device();
  int told = 0;
  for (int kill = 0; kill < kills(); ++kill) {
    // Always at the same port: a server that comes back gets the frames of the old session.
    std::unique_ptr<Served> server;
    if (kill > 0) {
      server = std::make_unique<Served>(
          std::vector<std::string>{"--engine", "model", "--timeout", std::to_string(kTimeout)},
          address);
    }
    Background& victim = kill > 0 ? server->program() : first.program();
    Background client({"build", "scene:knot:20k", "--device", device, "--device-timeout",
                       std::to_string(kTimeout), "--quiet"});
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 700));
    victim.signal(SIGKILL);
    victim.wait();
    const int code = client.wait();
    EXPECT_TRUE(code == 3 || code == 0) << code;
    if (code == 3) ++told;
  }
  EXPECT_GT(told, 0);
}

TEST(Serve, AKilledClientFreesTheServer) {
  std::mt19937 random(2);
  Served server({"--engine", "model", "--timeout", std::to_string(kTimeout)});
  for (int kill = 0; kill < kills(); ++kill) {
    Background client({"build", "scene:knot:20k", "--device", server.device(), "--quiet"});
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 700));
    client.signal(SIGKILL);
    client.wait();
    const RunResult next =
        run({"build", "scene:knot:200", "--device", server.device(), "--device-wait", "60"});
    ASSERT_EQ(next.exit_code, 0) << next.err;
  }
  server.program().signal(SIGTERM);
  EXPECT_EQ(server.program().wait(), 0);
}

}  // namespace
}  // namespace fasttree::cli
