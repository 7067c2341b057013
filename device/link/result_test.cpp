// SPDX-License-Identifier: Apache-2.0
#include "device/link/result.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "device/link/messages.h"
#include "device/link/stream_memory.h"
#include "device/link/wire.h"
#include "fasttree/build.h"
#include "tests/support/meshes.h"

namespace fasttree::device {
namespace {

Outcome some_outcome() {
  test::Random random(5);
  test::OwnedMesh mesh;
  for (int i = 0; i < 200; ++i) {
    const auto point = [&] { return Vec3{random.in(0, 1), random.in(0, 1), random.in(0, 1)}; };
    mesh.add(point(), point(), point());
  }
  BuildSettings settings;
  settings.profile = Profile::paper;
  Outcome outcome;
  outcome.tree = Builder().build(mesh.view(), settings).value();
  outcome.counters = {12345, 100.5, 0.25, {{"radix_sort", 10, 20, 0}, {"leaf_node", 0, 0, 1.5}}};
  return outcome;
}

// The stream as the other side has it.
StreamMemory stream_of(const Outcome& outcome) {
  const ResultSource source(outcome);
  const StreamMemory memory = StreamMemory::allocate(source.size());
  // In frames that end anywhere.
  for (std::uint64_t at = 0; at < source.size(); at += 1008) {
    const auto bytes = std::min<std::uint64_t>(1008, source.size() - at);
    source.read(at, memory.bytes().subspan(at, bytes));
  }
  return memory;
}

TEST(ResultStream, ComesBack) {
  const Outcome outcome = some_outcome();
  const StreamMemory memory = stream_of(outcome);
  const auto read = parse_result(memory.bytes(), memory.owner());
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().tree.hash(), outcome.tree.hash());
  EXPECT_EQ(read.value().tree.info(), outcome.tree.info());
  const Counters& counters = read.value().counters;
  EXPECT_EQ(counters.cycles, 12345u);
  EXPECT_EQ(counters.clock_mhz, 100.5);
  EXPECT_EQ(counters.build_ms, 0.25);
  ASSERT_EQ(counters.stages.size(), 2u);
  EXPECT_EQ(counters.stages[0].stage, "radix_sort");
  EXPECT_EQ(counters.stages[0].end_cycle, 20u);
  EXPECT_EQ(counters.stages[1].ms, 1.5);
}

TEST(ResultStream, AnEmptyTreeComesBack) {
  const StreamMemory memory = stream_of({});
  const auto read = parse_result(memory.bytes(), memory.owner());
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().tree.hash(), Tree().hash());
}

TEST(ResultStream, OtherSizesAndValuesAreRefused) {
  const StreamMemory memory = stream_of(some_outcome());
  const auto refused = [&](auto change, std::size_t shorter = 0) {
    const StreamMemory copy = StreamMemory::allocate(memory.bytes().size());
    std::memcpy(copy.bytes().data(), memory.bytes().data(), copy.bytes().size());
    change(copy.bytes());
    const auto bytes = copy.bytes().first(copy.bytes().size() - shorter);
    const auto read = parse_result(bytes, copy.owner());
    return !read.ok() && read.status().code() == StatusCode::bad_input;
  };
  const auto nothing = [](Body) {};
  EXPECT_FALSE(refused(nothing));
  EXPECT_TRUE(refused(nothing, 1));
  EXPECT_TRUE(refused(nothing, 4));
  EXPECT_TRUE(refused(nothing, memory.bytes().size() - 100));
  EXPECT_TRUE(refused(nothing, memory.bytes().size() - 130));
  EXPECT_TRUE(refused([](Body b) { put(b, 0, std::uint64_t{0}); }));
  EXPECT_TRUE(refused([](Body b) { put(b, 0, ~std::uint64_t{0}); }));
  EXPECT_TRUE(refused([](Body b) { put(b, 8, std::uint64_t{1} << 62); }));
  EXPECT_TRUE(refused([](Body b) { put(b, 48, std::uint32_t{1} << 30); }));
  EXPECT_TRUE(refused([](Body b) { put(b, 56, std::uint8_t{9}); }));
  EXPECT_TRUE(refused([](Body b) { b[b.size() - 1] ^= std::byte{1}; })) << "another hash";
  EXPECT_FALSE(refused([](Body b) { put(b, 16, std::uint64_t{0}); })) << "no hash is no lie";
}

TEST(SceneSource, GathersIndexedTriangles) {
  const float positions[] = {0, 0, 0, -1, 1, 0, 0, -1, 0, 1, 0, -1, 0, 0, 1, -1};  // stride 16
  const std::uint32_t indices[] = {0, 1, 2, 3, 2, 1};
  MeshView mesh;
  mesh.positions = positions;
  mesh.position_stride_bytes = 16;
  mesh.vertex_count = 4;
  mesh.indices = indices;
  mesh.triangle_count = 2;
  const SceneSource source(mesh);
  ASSERT_EQ(source.size(), 72u);
  float out[9];
  source.read(36, std::as_writable_bytes(std::span(out)));
  const float expected[] = {0, 0, 1, 0, 1, 0, 1, 0, 0};
  EXPECT_EQ(std::memcmp(out, expected, sizeof out), 0);
}

}  // namespace
}  // namespace fasttree::device
