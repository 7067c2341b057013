// SPDX-License-Identifier: Apache-2.0
// Many sessions over a bad network, and many that are killed at some moment: each ends in time,
// with the right tree or a clear error, and the server serves the next.
//
// FASTTREE_DEVICE_BUILDS and FASTTREE_DEVICE_KILLS ask for more of them.
#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "device/testing/many.h"
#include "device/testing/simulated_world.h"
#include "tests/support/meshes.h"

namespace fasttree::device {
namespace {

using test::asked;
using test::Impairment;
using test::resident_kib;
using test::SimulatedWorld;

/// Meshes to choose from, and the trees they give.
class Scenes {
 public:
  Scenes() {
    fasttree::test::Random random(11);
    const auto point = [&] { return Vec3{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)}; };
    for (int i = 0; i < 40; ++i) {
      Case one;
      for (int t = 0; t < i * i / 4; ++t) one.mesh.add(point(), point(), point());
      one.order.profile = i % 2 == 0 ? Profile::paper : Profile::realtime;
      one.order.axes = i % 3 == 0 ? AxisSchedule::longest : AxisSchedule::cyclic;
      one.order.memory_limit_bytes = 0;
      one.hash = Builder().build(one.mesh.view(), settings_of(one.order)).value().hash();
      cases_.push_back(std::move(one));
    }
  }
  struct Case {
    fasttree::test::OwnedMesh mesh;
    Order order;
    std::uint64_t hash = 0;
  };
  const Case& pick(test::LossyNetwork& dice) const { return cases_[dice.below(cases_.size())]; }

 private:
  std::vector<Case> cases_;
};

ServerSettings server_settings() {
  ServerSettings settings;
  settings.description = {"library", "", "test", 10'000'000, false};
  settings.timeout_ms = 1000;
  return settings;
}

std::uint64_t hash_of(const ClientSession& client) {
  const auto outcome = parse_result(client.result().bytes(), client.result().owner());
  return outcome.ok() ? outcome.value().tree.hash() : 0;
}

TEST(Endurance, ManyBuildsOverABadNetwork) {
  const std::uint64_t builds = asked("FASTTREE_DEVICE_BUILDS", 1000);
  const Scenes scenes;
  Impairment bad = Impairment::all(0.05);
  bad.corrupt = bad.truncate = 0.01;
  bad.jitter = 200;
  SimulatedWorld world(server_settings(), bad, 7);
  LinkCounts clients;
  std::uint64_t resident = 0;
  for (std::uint64_t build = 0; build < builds; ++build) {
    const Scenes::Case& scene = scenes.pick(world.network);
    const SceneSource source(scene.mesh.view());
    ClientSettings settings;
    settings.timeout_ms = 1000;
    settings.patience_ms = 1000;  // the last session's goodbye may be on its way
    ClientSession client(settings, 1000 + build, scene.order, source, SimulatedWorld::server_peer(),
                         world.now);
    world.run(client);
    ASSERT_TRUE(client.status().ok()) << build << ": " << client.status().message();
    ASSERT_EQ(hash_of(client), scene.hash) << build;
    clients += client.counts();
    (void)world.server->take_ends();
    if (build == builds / 10) resident = resident_kib();
  }
  const LinkCounts& server = world.server->counts();
  std::cout << builds << " builds: " << clients.frames_sent + server.frames_sent << " frames, "
            << clients.retransmitted + server.retransmitted << " data frames sent again, "
            << clients.dropped() + server.dropped() << " dropped as bad or late; resident memory "
            << resident << " KiB after a tenth of them, " << resident_kib() << " KiB at the end\n";
  EXPECT_GT(clients.retransmitted + server.retransmitted, builds / 10);
  EXPECT_GT(clients.bad_checksum + server.bad_checksum, 0u);
  if (test::kMemoryIsFlat) {
    EXPECT_LT(resident_kib(), resident + 2048);
  }
}

TEST(Endurance, KilledAtAnyMomentTheOtherSideEndsInTimeAndServesTheNext) {
  const std::uint64_t kills = asked("FASTTREE_DEVICE_KILLS", 400);
  constexpr Micros kTimeout = 1'000'000;
  const Scenes scenes;
  Impairment bad = Impairment::all(0.02);
  SimulatedWorld world(server_settings(), bad, 8);
  std::uint64_t in_session = 0, told = 0;
  for (std::uint64_t kill = 0; kill < kills; ++kill) {
    const bool kill_server = kill % 2 == 0;
    const Scenes::Case& scene = scenes.pick(world.network);
    const SceneSource source(scene.mesh.view());
    world.build_time = 2000 + world.network.below(18'000);
    ClientSettings settings;
    settings.timeout_ms = 1000;
    settings.patience_ms = 3000;
    auto client = std::make_unique<ClientSession>(settings, 10 * kill, scene.order, source,
                                                  SimulatedWorld::server_peer(), world.now);
    ClientSession* one[] = {client.get()};
    // Any moment of a session, and now and then one after it.
    const Micros moment = world.now + world.network.below(world.build_time + 2000);
    while (!client->ended() && world.now < moment && world.step(one, moment)) {
    }
    const bool was_open = world.server->in_session();
    if (was_open) ++in_session;
    const Micros killed = world.now;
    if (kill_server) {
      world.kill_server();
      world.run(*client);
      ASSERT_TRUE(client->ended());
      ASSERT_LE(world.now, killed + kTimeout + 100'000) << kill;
      if (client->status().ok()) {
        ASSERT_EQ(hash_of(*client), scene.hash);
      } else {
        ++told;
        ASSERT_EQ(client->status().code(), StatusCode::io_error);
      }
      world.start_server();
    } else {
      client.reset();
      while (world.server->busy() && world.step({})) {
        ASSERT_LE(world.now, killed + kTimeout + 100'000) << kill;
      }
      if (was_open) ++told;
    }
    // The next one, from the same address.
    ClientSession next(settings, 10 * kill + 1, scene.order, source, SimulatedWorld::server_peer(),
                       world.now);
    world.build_time = 300;
    world.run(next);
    ASSERT_TRUE(next.status().ok()) << kill << ": " << next.status().message();
    ASSERT_EQ(hash_of(next), scene.hash);
  }
  std::cout << kills << " kills, " << in_session << " of them within a session, " << told
            << " noticed by the other side\n";
  EXPECT_GT(in_session, kills / 2);
}

}  // namespace
}  // namespace fasttree::device
