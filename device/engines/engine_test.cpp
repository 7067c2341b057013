// SPDX-License-Identifier: Apache-2.0
// Devices in this process.
#include "device/engines/engine.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

#include "device/engines/local_device.h"
#include "model/memory/make_memory.h"
#include "tests/support/meshes.h"

namespace fasttree::device {
namespace {

using std::chrono::milliseconds;

fasttree::test::OwnedMesh random_mesh(int triangles) {
  fasttree::test::Random random(2);
  fasttree::test::OwnedMesh mesh;
  const auto point = [&] { return Vec3{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)}; };
  for (int i = 0; i < triangles; ++i) mesh.add(point(), point(), point());
  return mesh;
}

TEST(Engines, LibraryFollowsTheOrder) {
  const auto mesh = random_mesh(300);
  LocalDevice device(library_engine(), 1);
  for (const Profile profile : {Profile::paper, Profile::realtime, Profile::sah_binned}) {
    BuildSettings settings;
    settings.profile = profile;
    settings.axes = AxisSchedule::longest;
    const auto built = build_on(device, mesh.view(), order_of(settings));
    ASSERT_TRUE(built.ok()) << built.status().message();
    EXPECT_EQ(built.value().tree.hash(), Builder().build(mesh.view(), settings).value().hash());
    EXPECT_EQ(built.value().counters.cycles, 0u);
    EXPECT_GT(built.value().counters.build_ms, 0);
    EXPECT_FALSE(built.value().counters.stages.empty());
  }
}

TEST(Engines, MachinesFollowTheirConfiguration) {
  const auto mesh = random_mesh(200);
  for (const char* config : {"paper-fpga", "fasttree-2"}) {
    LocalDevice device(make_engine("model", config).value(), 1);
    EXPECT_EQ(device.describe().value().config, config);
    const auto built = build_on(device, mesh.view(), Order());
    ASSERT_TRUE(built.ok()) << built.status().message();
    const Outcome& outcome = built.value();
    BuildSettings same;
    same.profile = outcome.tree.info().profile;
    same.axes = outcome.tree.info().axes;
    same.depth = same.profile == Profile::paper ? outcome.tree.info().depth : kAutoDepth;
    EXPECT_EQ(outcome.tree.hash(), Builder().build(mesh.view(), same).value().hash()) << config;
    EXPECT_GT(outcome.counters.cycles, 1000u);
    EXPECT_NEAR(outcome.counters.build_ms,
                static_cast<double>(outcome.counters.cycles) / outcome.counters.clock_mhz / 1000,
                1e-6);
    EXPECT_FALSE(outcome.counters.stages.empty());
  }
}

TEST(Engines, MachinesHoldWhatTheirMemoryHolds) {
  for (const char* config : {"paper-fpga", "fasttree-2"}) {
    const std::uint64_t capacity =
        model::make_memory(model::load_config(config).value().memory)->traits().capacity_bytes;
    ASSERT_GT(capacity, 0u);
    LocalDevice device(make_engine("model", config).value(), 1);
    EXPECT_EQ(device.describe().value().most_scene_bytes, capacity);
  }
  EXPECT_EQ(library_engine().most_scene_bytes, std::uint64_t{36} * kMaxTriangles);
}

TEST(Engines, RtlBuildsOrSaysWhyNot) {
  const auto mesh = random_mesh(100);
  const auto engine = make_engine("rtl", "paper-fpga");
  if (!engine.ok()) {
    EXPECT_EQ(engine.status().code(), StatusCode::invalid_argument);
    GTEST_SKIP() << engine.status().message();
  }
  LocalDevice device(engine.value(), 1);
  const auto built = build_on(device, mesh.view(), Order());
  ASSERT_TRUE(built.ok()) << built.status().message();
  const TreeInfo& info = built.value().tree.info();
  BuildSettings same;
  same.profile = Profile::paper;
  same.axes = info.axes;
  same.depth = info.depth;
  EXPECT_EQ(built.value().tree.hash(), Builder().build(mesh.view(), same).value().hash());
}

TEST(Engines, WrongNamesAreRefused) {
  EXPECT_EQ(make_engine("fpga", "").status().code(), StatusCode::invalid_argument);
  EXPECT_EQ(make_engine("library", "paper-fpga").status().code(), StatusCode::invalid_argument);
  EXPECT_FALSE(make_engine("model", "no-such-machine").ok());
  // There is none, before anything is built.
  EXPECT_EQ(make_engine("rtl", "fasttree-2").status().code(), StatusCode::invalid_argument);
}

TEST(LocalDevice, KeepsToItsOrder) {
  const auto mesh = random_mesh(10);
  LocalDevice device(library_engine(), 1);
  EXPECT_EQ(device.start(Order(), {}).code(), StatusCode::invalid_argument);
  EXPECT_EQ(device.read_result().status().code(), StatusCode::invalid_argument);
  ASSERT_TRUE(device.write_scene(mesh.view()).ok());
  EXPECT_EQ(device.read_result().status().code(), StatusCode::invalid_argument);
  ASSERT_TRUE(device.start(Order(), {}).ok());
  while (!device.wait_for(milliseconds(1000))) {
  }
  EXPECT_TRUE(device.read_result().ok());
  EXPECT_EQ(device.read_result().status().code(), StatusCode::invalid_argument) << "read twice";
  const std::uint32_t bad[] = {0, 1, 99};
  MeshView view = mesh.view();
  view.indices = bad;
  view.triangle_count = 1;
  EXPECT_EQ(device.write_scene(view).code(), StatusCode::bad_input);
}

// An engine that runs until it is cancelled.
Engine endless_engine() {
  Engine engine{"library", "", 1 << 20, {}};
  engine.build = [](const MeshView&, const Order&,
                    const ProgressCallback& progress) -> Result<Outcome> {
    while (progress("waiting", 0.5)) std::this_thread::sleep_for(milliseconds(1));
    return Status(StatusCode::cancelled, "cancelled");
  };
  return engine;
}

TEST(LocalDevice, CanBeCancelledAndIsBusyUntilThen) {
  const auto mesh = random_mesh(10);
  LocalDevice device(endless_engine(), 1);
  bool ended = false;
  ASSERT_TRUE(device.write_scene(mesh.view()).ok());
  ASSERT_TRUE(device.start(Order(), [&] { ended = true; }).ok());
  while (device.progress().stage != "waiting") EXPECT_FALSE(device.wait_for(milliseconds(1)));
  EXPECT_EQ(device.start(Order(), {}).code(), StatusCode::invalid_argument);
  EXPECT_EQ(device.write_scene(mesh.view()).code(), StatusCode::invalid_argument);
  EXPECT_TRUE(device.describe().value().busy);
  device.cancel();
  std::optional<Status> status;
  while (!(status = device.wait_for(milliseconds(100)))) {
  }
  EXPECT_EQ(status->code(), StatusCode::cancelled);
  EXPECT_TRUE(ended);
  EXPECT_FALSE(device.describe().value().busy);
}

TEST(LocalDevice, GoesAwayWithABuildRunning) {
  const auto mesh = random_mesh(10);
  LocalDevice device(endless_engine(), 1);
  ASSERT_TRUE(device.write_scene(mesh.view()).ok());
  ASSERT_TRUE(device.start(Order(), {}).ok());
}

TEST(LocalDevice, AnEngineThatThrowsHasFailed) {
  const auto mesh = random_mesh(10);
  Engine engine{"library", "", 1 << 20, {}};
  engine.build = [](const MeshView&, const Order&, const ProgressCallback&) -> Result<Outcome> {
    throw std::bad_alloc();
  };
  LocalDevice device(engine, 1);
  EXPECT_EQ(build_on(device, mesh.view(), Order()).status().code(), StatusCode::resource_limit);
}

}  // namespace
}  // namespace fasttree::device
