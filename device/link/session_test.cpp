// SPDX-License-Identifier: Apache-2.0
// Both sides of a session over a simulated network: what is promised in docs/protocol.md.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "device/link/wire.h"
#include "device/testing/simulated_world.h"
#include "tests/support/meshes.h"

namespace fasttree::device {
namespace {

using test::Impairment;
using test::SimulatedWorld;

fasttree::test::OwnedMesh random_mesh(std::uint64_t seed, int triangles) {
  fasttree::test::Random random(seed);
  fasttree::test::OwnedMesh mesh;
  const auto point = [&] { return Vec3{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)}; };
  for (int i = 0; i < triangles; ++i) mesh.add(point(), point(), point());
  return mesh;
}

ServerSettings server_settings() {
  ServerSettings settings;
  settings.description = {"library", "", "test", 100'000'000, false};
  return settings;
}

class Sessions : public testing::Test {
 protected:
  explicit Sessions(const Impairment& impairment = {})
      : world_(server_settings(), impairment, 1), mesh_(random_mesh(1, 500)), scene_(mesh_.view()) {
    settings_.timeout_ms = 1000;
  }

  ClientSession client(std::uint64_t session) {
    return ClientSession(settings_, session, order_, scene_, SimulatedWorld::server_peer(),
                         world_.now);
  }

  std::uint64_t expected_hash() const {
    return Builder().build(mesh_.view(), settings_of(order_)).value().hash();
  }

  static std::uint64_t hash_of(const ClientSession& client) {
    const auto outcome = parse_result(client.result().bytes(), client.result().owner());
    return outcome.ok() ? outcome.value().tree.hash() : 0;
  }

  void expect_served(std::uint64_t session) {
    ClientSession next = client(session);
    world_.run(next);
    EXPECT_TRUE(next.status().ok()) << next.status().message();
    EXPECT_EQ(hash_of(next), expected_hash());
  }

  SimulatedWorld world_;
  ClientSettings settings_;
  Order order_;
  fasttree::test::OwnedMesh mesh_;
  SceneSource scene_;
};

TEST_F(Sessions, BuildTheTreeOfEveryProfile) {
  Impairment orderly;
  orderly.jitter = 0;
  world_.network.set(orderly);
  std::uint64_t session = 1;
  for (const Profile profile :
       {Profile::paper, Profile::sah_exact, Profile::sah_binned, Profile::realtime}) {
    order_.profile = profile;
    expect_served(session++);
  }
  const auto ends = world_.server->take_ends();
  ASSERT_EQ(ends.size(), 4u);
  for (const SessionEnd& end : ends) {
    EXPECT_TRUE(end.status.ok()) << end.status.message();
    EXPECT_EQ(end.scene_bytes, 500u * 36);
    EXPECT_GT(end.result_bytes, 500u);
  }
  const LinkCounts& c = world_.server->counts();
  EXPECT_EQ(c.dropped(), 0u) << c.wrong_session << c.duplicates << c.out_of_window << c.bad_content;
}

TEST_F(Sessions, AnEmptySceneIsBuiltToo) {
  mesh_ = {};
  scene_ = SceneSource(mesh_.view());
  expect_served(1);
}

TEST_F(Sessions, TheSmallerPayloadAndTimeoutAreAgreedOn) {
  settings_.payload = 720;
  ClientSession one = client(1);
  world_.run(one);
  ASSERT_TRUE(one.status().ok());
  EXPECT_EQ(one.counts().data_bytes_sent, 500u * 36);
  // 25 data frames of 720 bytes; then hello, acks and close.
  EXPECT_GE(one.counts().frames_sent, 25u + 3);
}

TEST_F(Sessions, ASceneOverTheLimitIsRefusedBeforeAnythingIsAllocated) {
  struct Huge : ByteSource {
    std::uint64_t size() const override { return (std::uint64_t{1} << 40) / 36 * 36; }
    void read(std::uint64_t, std::span<std::byte>) const override { ADD_FAILURE(); }
  } huge;
  ClientSession one(settings_, 1, order_, huge, SimulatedWorld::server_peer(), world_.now);
  world_.run(one);
  EXPECT_EQ(one.status().code(), StatusCode::resource_limit);
  EXPECT_NE(one.status().message().find("100000000"), std::string::npos) << one.status().message();
  EXPECT_FALSE(world_.server->busy());
  expect_served(2);
}

TEST_F(Sessions, AResultThatTheClientCannotHoldIsNotSent) {
  settings_.most_result_bytes = 1000;
  ClientSession one = client(1);
  world_.run(one);
  EXPECT_EQ(one.status().code(), StatusCode::resource_limit);
  EXPECT_EQ(one.counts().data_bytes_received, 0u);
  settings_.most_result_bytes = ~std::uint64_t{0};
  expect_served(2);
}

TEST_F(Sessions, AFailedBuildIsReportedInItsWords) {
  world_.engine = [](const SceneOrder&) -> Result<Outcome> {
    return Status(StatusCode::bad_input, "triangle 7: coordinate is not finite");
  };
  ClientSession one = client(1);
  world_.run(one);
  EXPECT_EQ(one.status().code(), StatusCode::bad_input);
  EXPECT_EQ(one.status().message(), "triangle 7: coordinate is not finite");
  world_.engine = test::build_outcome;
  expect_served(2);
}

TEST_F(Sessions, ASecondClientIsToldThatItIsBusyAndDisturbsNothing) {
  world_.build_time = 200'000;
  ClientSession one = client(1), two = client(2);
  ClientSession* both[] = {&one, &two};
  while (!two.ended()) ASSERT_TRUE(world_.step(both));
  // One of them came first; the dice of the network decide.
  ClientSession& first = two.status().ok() ? two : one;
  while (!one.ended()) ASSERT_TRUE(world_.step(both));
  ClientSession& second = &first == &one ? two : one;
  EXPECT_TRUE(first.status().ok()) << first.status().message();
  EXPECT_EQ(hash_of(first), expected_hash());
  EXPECT_EQ(second.status().code(), StatusCode::io_error);
  EXPECT_NE(second.status().message().find("busy"), std::string::npos);
}

TEST_F(Sessions, APatientClientGetsItsTurn) {
  world_.build_time = 200'000;
  settings_.patience_ms = 2000;
  ClientSession one = client(1), two = client(2), three = client(3);
  ClientSession* all[] = {&one, &two, &three};
  while (!one.ended() || !two.ended() || !three.ended()) ASSERT_TRUE(world_.step(all));
  for (const ClientSession* each : all) {
    EXPECT_TRUE(each->status().ok()) << each->status().message();
    EXPECT_EQ(hash_of(*each), expected_hash());
  }
}

TEST_F(Sessions, ALongBuildIsKeptAliveAndItsProgressSeen) {
  world_.build_time = 30'000'000;  // thirty times the time-out
  ClientSession one = client(1);
  ClientSession* just[] = {&one};
  bool seen = false;
  while (!one.ended() && world_.step(just)) {
    world_.server->engine_progress({"radix_sort", 0.5});
    seen = seen || (one.progress().stage == "radix_sort" && one.progress().fraction == 0.5);
  }
  EXPECT_TRUE(one.status().ok()) << one.status().message();
  EXPECT_TRUE(seen);
}

TEST_F(Sessions, CancellingEndsBothSidesSoon) {
  world_.build_time = 30'000'000;
  ClientSession one = client(1);
  ClientSession* just[] = {&one};
  while (one.progress().stage != "starting" && world_.step(just)) {
  }
  const Micros asked = world_.now;
  one.cancel(world_.now);
  world_.run(one);
  EXPECT_EQ(one.status().code(), StatusCode::cancelled);
  EXPECT_LT(world_.now - asked, 10'000u);
  world_.pass(1000);
  EXPECT_FALSE(world_.server->busy());
  const auto ends = world_.server->take_ends();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].status.code(), StatusCode::cancelled);
  world_.build_time = 300;
  expect_served(2);
}

TEST_F(Sessions, AServerThatStopsSaysSo) {
  world_.build_time = 30'000'000;
  ClientSession one = client(1);
  ClientSession* just[] = {&one};
  while (one.progress().stage != "starting" && world_.step(just)) {
  }
  world_.server->stop(world_.now);
  world_.run(one);
  EXPECT_EQ(one.status().code(), StatusCode::io_error);
  EXPECT_NE(one.status().message().find("stopped"), std::string::npos);
}

TEST_F(Sessions, NobodyThereIsSaidAfterTheTimeout) {
  world_.kill_server();
  ClientSession one = client(1);
  const Micros begin = world_.now;
  world_.run(one);
  EXPECT_EQ(one.status().code(), StatusCode::io_error);
  EXPECT_NE(one.status().message().find("no answer in 1 s"), std::string::npos);
  EXPECT_EQ(world_.now - begin, 1'000'000u);
}

TEST_F(Sessions, AServerStartedAnewAnswersFramesOfTheOldSessionWithReset) {
  world_.build_time = 30'000'000;
  ClientSession one = client(1);
  ClientSession* just[] = {&one};
  while (one.progress().stage != "starting" && world_.step(just)) {
  }
  world_.kill_server();
  world_.start_server();
  // Any frame of the client's will do; it answers a stray progress.
  Outbox out;
  write_progress({"x", 0}, out.body(kProgressBytes));
  out.commit({FrameType::progress, 1, 99, 0}, kProgressBytes, SimulatedWorld::client_peer(0));
  world_.network.send(SimulatedWorld::server_peer(), out, world_.now);
  const Micros begin = world_.now;
  world_.run(one);
  EXPECT_EQ(one.status().code(), StatusCode::io_error);
  EXPECT_NE(one.status().message().find("ended the session"), std::string::npos);
  EXPECT_LT(world_.now - begin, 10'000u);
  EXPECT_GE(world_.server->counts().wrong_session, 1u);
}

TEST_F(Sessions, FramesOfOldSessionsDoNotDisturbTheNext) {
  // Everything that the first session's client sends comes again in the middle of the second.
  ClientSession one = client(1);
  ClientSession* just[] = {&one};
  Impairment slow;
  slow.duplicate = 1;
  world_.network.set(slow);
  world_.run(one);
  ASSERT_TRUE(one.status().ok());
  std::vector<test::Datagram> old;
  for (const std::uint32_t sequence : {0u, 1u, 2u, 500u}) {
    for (const FrameType type :
         {FrameType::hello, FrameType::data, FrameType::ack, FrameType::alive, FrameType::close}) {
      Outbox out;
      const std::size_t bytes = type == FrameType::hello  ? kHelloBytes
                                : type == FrameType::data ? 1440
                                : type == FrameType::ack  ? 4
                                                          : kCloseBytes;
      std::fill_n(out.body(bytes).data(), bytes, std::byte{0});
      if (type == FrameType::hello) write_hello(Hello(), out.body(bytes));
      out.commit({type, 1, sequence, 0}, bytes, SimulatedWorld::server_peer());
      const auto bytes_out = out.datagram(out.entries()[0]);
      old.push_back({SimulatedWorld::client_peer(0),
                     SimulatedWorld::server_peer(),
                     {bytes_out.begin(), bytes_out.end()}});
    }
  }
  ClientSession two = client(2);
  just[0] = &two;
  std::size_t at = 0;
  while (!two.ended()) {
    world_.network.send(old[at++ % old.size()], world_.now);
    ASSERT_TRUE(world_.step(just));
  }
  EXPECT_TRUE(two.status().ok()) << two.status().message();
  EXPECT_EQ(hash_of(two), expected_hash());
  EXPECT_GT(world_.server->counts().wrong_session, 10u);
  world_.pass(3'000'000);
  EXPECT_FALSE(world_.server->busy()) << "an old hello has opened a session";
}

TEST_F(Sessions, AHelloAloneHoldsTheServerForASecondAtMost) {
  Outbox out;
  write_hello(Hello(), out.body(kHelloBytes));
  out.commit({FrameType::hello, 77, 0, 0}, kHelloBytes, SimulatedWorld::server_peer());
  Hello larger;
  larger.scene_bytes = 36'000;
  out.clear();
  write_hello(larger, out.body(kHelloBytes));
  out.commit({FrameType::hello, 78, 0, 0}, kHelloBytes, SimulatedWorld::server_peer());
  world_.network.send(SimulatedWorld::client_peer(5), out, world_.now);
  world_.pass(10'000);
  EXPECT_TRUE(world_.server->busy());
  world_.pass(1'000'000);
  EXPECT_FALSE(world_.server->busy());
  expect_served(2);
}

TEST_F(Sessions, AnothersFramesWithTheRightNumberAreNotTaken) {
  world_.build_time = 500'000;
  ClientSession one = client(1);
  ClientSession* just[] = {&one};
  while (!one.ended()) {
    Outbox out;
    write_close(Closing::cancelled, out.body(kCloseBytes));
    out.commit({FrameType::close, 1, 0, 0}, kCloseBytes, SimulatedWorld::server_peer());
    world_.network.send(SimulatedWorld::client_peer(9), out, world_.now);
    ASSERT_TRUE(world_.step(just));
  }
  EXPECT_TRUE(one.status().ok()) << one.status().message();
  EXPECT_GT(world_.server->counts().wrong_session, 0u);
}

TEST_F(Sessions, NobodyGetsMoreBytesThanWereSent) {
  // Answers to strangers, whose addresses may be somebody else's.
  std::size_t sent = 0;
  ServerSession& server = *world_.server;
  for (const auto& [type, bytes] :
       std::vector<std::pair<FrameType, std::size_t>>{{FrameType::describe, kDescriptionBytes},
                                                      {FrameType::describe, 0},
                                                      {FrameType::hello, 0},
                                                      {FrameType::hello, kRefuseBytes},
                                                      {FrameType::data, 0},
                                                      {FrameType::ack, 4},
                                                      {FrameType::alive, 0},
                                                      {FrameType::close, 4},
                                                      {FrameType::reset, 0},
                                                      {FrameType::offer, 8}}) {
    Outbox out;
    std::fill_n(out.body(bytes).data(), bytes, std::byte{0});
    out.commit({type, 4711, 0, 0}, bytes, SimulatedWorld::server_peer());
    server.on_datagram(out.datagram(out.entries()[0]), test::peer(9), world_.now);
    Outbox answer;
    server.poll(world_.now, answer);
    for (const auto& entry : answer.entries()) {
      EXPECT_LE(entry.bytes, out.entries()[0].bytes) << static_cast<int>(type);
      ++sent;
    }
  }
  EXPECT_EQ(sent, 6u);
}

TEST_F(Sessions, GarbageIsCountedAndDropped) {
  fasttree::test::Random random(4);
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> bytes(static_cast<std::size_t>(random.in(0, 200)));
    for (std::byte& b : bytes) b = static_cast<std::byte>(random.in(0, 255));
    if (i % 2 == 0 && bytes.size() > 4) {
      bytes[0] = std::byte{'F'};
      bytes[1] = std::byte{'T'};
      bytes[2] = std::byte{1};
    }
    world_.server->on_datagram(bytes, test::peer(9), world_.now);
  }
  EXPECT_EQ(world_.server->counts().dropped(), 2000u);
  EXPECT_FALSE(world_.server->busy());
  expect_served(2);
}

}  // namespace
}  // namespace fasttree::device
