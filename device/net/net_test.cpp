// SPDX-License-Identifier: Apache-2.0
// A remote device and a server over real sockets.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <iostream>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "device/engines/local_device.h"
#include "device/net/remote_device.h"
#include "device/net/server.h"
#include "device/testing/many.h"
#include "device/testing/udp_relay.h"
#include "tests/support/meshes.h"

namespace fasttree::device {
namespace {

using std::chrono::milliseconds;
using test::Impairment;
using test::UdpRelay;

fasttree::test::OwnedMesh random_mesh(int triangles) {
  fasttree::test::Random random(3);
  fasttree::test::OwnedMesh mesh;
  const auto point = [&] { return Vec3{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)}; };
  for (int i = 0; i < triangles; ++i) mesh.add(point(), point(), point());
  return mesh;
}

/// A server in a thread.
class Running {
 public:
  explicit Running(Engine engine, ServeSettings settings = {}) : device_(std::move(engine), 1) {
    settings.listen.port = 0;
    settings.timeout_ms = 2000;
    server_ = std::move(Server::open(settings, device_)).value();
    thread_ = std::thread([this] {
      server_->run([this] { return !stop_; },
                   [this](const SessionEnd& end) {
                     const std::lock_guard lock(mutex_);
                     if (ends_.size() < 16) ends_.push_back(end);  // memory is watched
                   });
    });
  }
  ~Running() { stop(); }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  const Address& address() const { return server_->address(); }
  std::vector<SessionEnd> ends() {
    const std::lock_guard lock(mutex_);
    return ends_;
  }
  const Server& server() const { return *server_; }  // after stop()

 private:
  LocalDevice device_;
  std::unique_ptr<Server> server_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::vector<SessionEnd> ends_;
  std::thread thread_;
};

ClientSettings client_settings() {
  ClientSettings settings;
  settings.timeout_ms = 2000;
  settings.patience_ms = 2000;
  return settings;
}

Engine endless_engine() {
  Engine engine{"library", "", 1 << 20, {}};
  engine.build = [](const MeshView&, const Order&,
                    const ProgressCallback& progress) -> Result<Outcome> {
    while (progress("waiting", 0.5)) std::this_thread::sleep_for(milliseconds(1));
    return Status(StatusCode::cancelled, "cancelled");
  };
  return engine;
}

void expect_builds(Device& device, const fasttree::test::OwnedMesh& mesh) {
  Order order;
  order.profile = Profile::paper;
  const auto built = build_on(device, mesh.view(), order);
  ASSERT_TRUE(built.ok()) << built.status().message();
  EXPECT_EQ(built.value().tree.hash(),
            Builder().build(mesh.view(), settings_of(order)).value().hash());
}

TEST(Remote, BuildsWithEachSizeOfFrame) {
  Running server(library_engine());
  const auto mesh = random_mesh(20'000);
  for (const std::uint32_t payload : {36u, kEthernetPayload, kJumboPayload, kLargestPayload}) {
    ClientSettings settings = client_settings();
    settings.payload = payload;
    RemoteDevice device(server.address(), settings);
    expect_builds(device, mesh);
  }
}

TEST(Remote, SaysWhatItIs) {
  ServeSettings settings;
  settings.program = "a test";
  settings.memory_limit_bytes = 123456;
  Running server(make_engine("model", "paper-fpga").value(), settings);
  RemoteDevice device(server.address(), client_settings());
  const auto description = device.describe();
  ASSERT_TRUE(description.ok()) << description.status().message();
  EXPECT_EQ(description.value().engine, "model");
  EXPECT_EQ(description.value().config, "paper-fpga");
  EXPECT_EQ(description.value().program, "a test");
  EXPECT_EQ(description.value().most_scene_bytes, 123456u);
  EXPECT_FALSE(description.value().busy);
}

TEST(Remote, AMachinesCountersCross) {
  Running server(make_engine("model", "paper-fpga").value());
  const auto mesh = random_mesh(200);
  LocalDevice local(make_engine("model", "paper-fpga").value(), 1);
  RemoteDevice remote(server.address(), client_settings());
  const auto here = build_on(local, mesh.view(), Order()),
             there = build_on(remote, mesh.view(), Order());
  ASSERT_TRUE(there.ok()) << there.status().message();
  EXPECT_EQ(there.value().tree.hash(), here.value().tree.hash());
  EXPECT_EQ(there.value().tree.info(), here.value().tree.info());
  EXPECT_EQ(there.value().counters.cycles, here.value().counters.cycles);
  EXPECT_EQ(there.value().counters.clock_mhz, here.value().counters.clock_mhz);
  ASSERT_EQ(there.value().counters.stages.size(), here.value().counters.stages.size());
  EXPECT_EQ(there.value().counters.stages[1].end_cycle, here.value().counters.stages[1].end_cycle);
}

TEST(Remote, NobodyThereIsSaidSoon) {
  std::uint16_t free = 0;
  { free = UdpPort::listen({"127.0.0.1", 0}).value().address().port; }
  RemoteDevice device({"127.0.0.1", free}, client_settings());
  for (const Status& status :
       {build_on(device, random_mesh(5).view(), Order()).status(), device.describe().status()}) {
    EXPECT_EQ(status.code(), StatusCode::io_error);
    EXPECT_NE(status.message().find("127.0.0.1:" + std::to_string(free)), std::string::npos);
    EXPECT_NE(status.message().find("fasttree serve"), std::string::npos) << status.message();
  }
}

TEST(Remote, UnknownHostsAndTakenPortsAreSaid) {
  RemoteDevice device({"no-such-host.invalid", 1}, client_settings());
  const Status status = build_on(device, random_mesh(5).view(), Order()).status();
  EXPECT_EQ(status.code(), StatusCode::io_error);
  EXPECT_NE(status.message().find("no-such-host.invalid:1"), std::string::npos);
  const UdpPort taken = UdpPort::listen({"127.0.0.1", 0}).value();
  const auto again = UdpPort::listen(taken.address());
  ASSERT_FALSE(again.ok());
  EXPECT_NE(again.status().message().find("cannot listen"), std::string::npos);
}

TEST(Remote, ASceneOverTheLimitIsRefused) {
  ServeSettings settings;
  settings.memory_limit_bytes = 36 * 100;
  Running server(library_engine(), settings);
  RemoteDevice device(server.address(), client_settings());
  EXPECT_EQ(build_on(device, random_mesh(101).view(), Order()).status().code(),
            StatusCode::resource_limit);
}

TEST(Remote, ABuildOverTheLimitIsRefused) {
  ServeSettings settings;
  settings.memory_limit_bytes = 36 * 20'000 + 1000;
  Running server(library_engine(), settings);
  RemoteDevice device(server.address(), client_settings());
  EXPECT_EQ(build_on(device, random_mesh(20'000).view(), Order()).status().code(),
            StatusCode::resource_limit);
  expect_builds(device, random_mesh(10));
}

TEST(Remote, ABadSceneIsReportedByTheEngine) {
  Running server(library_engine());
  auto mesh = random_mesh(10);
  mesh.positions[5].y = std::numeric_limits<float>::quiet_NaN();
  RemoteDevice device(server.address(), client_settings());
  const Status status = build_on(device, mesh.view(), Order()).status();
  EXPECT_EQ(status.code(), StatusCode::bad_input);
  EXPECT_NE(status.message().find("triangle 1"), std::string::npos) << status.message();
}

TEST(Remote, CancellingStopsTheEngineAndFreesTheServer) {
  Running server(endless_engine());
  const auto mesh = random_mesh(100);
  for (int round = 0; round < 3; ++round) {
    RemoteDevice device(server.address(), client_settings());
    ASSERT_TRUE(device.write_scene(mesh.view()).ok());
    ASSERT_TRUE(device.start(Order(), {}).ok());
    while (device.progress().stage != "waiting") std::this_thread::sleep_for(milliseconds(1));
    device.cancel();
    std::optional<Status> status;
    while (!(status = device.wait_for(milliseconds(100)))) {
    }
    EXPECT_EQ(status->code(), StatusCode::cancelled);
  }
  server.stop();
  const auto ends = server.ends();
  ASSERT_EQ(ends.size(), 3u);
  for (const SessionEnd& end : ends) EXPECT_EQ(end.status.code(), StatusCode::cancelled);
}

TEST(Remote, AServerThatStopsTellsItsClient) {
  auto server = std::make_unique<Running>(endless_engine());
  RemoteDevice device(server->address(), client_settings());
  const auto mesh = random_mesh(100);
  ASSERT_TRUE(device.write_scene(mesh.view()).ok());
  ASSERT_TRUE(device.start(Order(), {}).ok());
  while (device.progress().stage != "waiting") std::this_thread::sleep_for(milliseconds(1));
  server->stop();
  std::optional<Status> status;
  while (!(status = device.wait_for(milliseconds(100)))) {
  }
  EXPECT_EQ(status->code(), StatusCode::io_error);
  EXPECT_NE(status->message().find("stopped"), std::string::npos) << status->message();
}

TEST(Remote, TheSecondOfTwoIsToldThatItIsBusy) {
  Running server(endless_engine());
  const auto mesh = random_mesh(100);
  RemoteDevice first(server.address(), client_settings());
  ASSERT_TRUE(first.write_scene(mesh.view()).ok());
  ASSERT_TRUE(first.start(Order(), {}).ok());
  while (first.progress().stage != "waiting") std::this_thread::sleep_for(milliseconds(1));
  ClientSettings hasty = client_settings();
  hasty.patience_ms = 0;
  RemoteDevice second(server.address(), hasty);
  EXPECT_TRUE(second.describe().value().busy);
  const Status status = build_on(second, mesh.view(), Order()).status();
  EXPECT_EQ(status.code(), StatusCode::io_error);
  EXPECT_NE(status.message().find("busy"), std::string::npos);
  first.cancel();
  while (!first.wait_for(milliseconds(100))) {
  }
}

TEST(Remote, BuildsThroughABadNetworkOfRealSockets) {
  const std::uint64_t builds = test::asked("FASTTREE_DEVICE_SOCKET_BUILDS", 60);
  Running server(library_engine());
  Impairment bad = Impairment::all(0.05);
  bad.corrupt = bad.truncate = 0.01;
  bad.jitter = 300;
  const UdpRelay relay(server.address(), bad, 5);
  const auto mesh = random_mesh(700);
  RemoteDevice device(relay.address(), client_settings());
  std::uint64_t resident = 0;
  for (std::uint64_t i = 0; i < builds; ++i) {
    expect_builds(device, mesh);
    if (i == builds / 2) resident = test::resident_kib();
  }
  EXPECT_GT(device.counts().retransmitted, 0u);
  server.stop();
  EXPECT_GT(server.server().counts().dropped(), 0u);
  std::cout << builds << " builds; resident memory " << resident << " KiB after half of them, "
            << test::resident_kib() << " KiB at the end\n";
  if (test::kMemoryIsFlat) {
    EXPECT_LT(test::resident_kib(), resident + 8192);
  }
}

}  // namespace
}  // namespace fasttree::device
