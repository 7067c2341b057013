// SPDX-License-Identifier: Apache-2.0
// The machine's tree is the reference builder's, whatever the configuration.
#include "model/fasttree2/machine.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "fasttree/build.h"
#include "model/config/machine_config.h"
#include "model/fasttree2/test_memory.h"
#include "tests/support/meshes.h"

namespace fasttree::model::ft2 {
namespace {

Result<Tree> reference_tree(const MeshView& mesh, const FastTree2Config& config) {
  BuildSettings settings;
  settings.profile = Profile::paper;
  settings.implementation = Implementation::reference;
  settings.axes = config.axes;
  settings.depth =
      config.depth == FastTree2Config::kDepthByRule ? kAutoDepth : static_cast<int>(config.depth);
  settings.extra_depth = static_cast<int>(config.extra_depth);
  settings.max_growth = config.max_growth;
  return Builder().build(mesh, settings);
}

/// Empty where the machine's tree is the reference's; else what differs.
std::string difference(const MeshView& mesh, const FastTree2Config& config,
                       const TestMemory::Shape& shape = {}, const Extras& extras = {},
                       Figures* figures = nullptr) {
  TestMemory memory(shape);
  const auto result = run(mesh, "test", config, 500, memory, {}, extras, figures);
  if (!result.ok()) return result.status().message();
  const Result<Tree> expected = reference_tree(mesh, config);
  if (!expected.ok()) return expected.status().message();
  const Tree& tree = result.value().tree;
  if (!(tree.info() == expected.value().info())) return "info";
  if (!std::ranges::equal(tree.ids(), expected.value().ids())) return "ids";
  if (!std::ranges::equal(tree.nodes(), expected.value().nodes())) return "nodes";
  if (tree.hash() != expected.value().hash()) return "hash";
  return "";
}

TEST(FastTree2, BuildsTheReferenceTreeOfDegenerateMeshes) {
  for (const auto& [name, mesh] : test::degenerate_meshes()) {
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      for (const bool given : {false, true}) {
        SCOPED_TRACE(name + " " + to_string(axes) + (given ? " given" : ""));
        FastTree2Config config;
        config.axes = axes;
        config.bounds_given = given;
        EXPECT_EQ(difference(mesh.view(), config), "");
      }
    }
  }
}

/// A configuration with sizes from tiny to ample.
FastTree2Config random_config() {
  const auto power = [](int lo, int hi) { return 1u << *rc::gen::inRange(lo, hi + 1); };
  const auto number = [](std::uint32_t lo, std::uint32_t hi) {
    return *rc::gen::inRange<std::uint32_t>(lo, hi + 1);
  };
  FastTree2Config c;
  c.axes = *rc::gen::element(AxisSchedule::cyclic, AxisSchedule::longest);
  c.depth = *rc::gen::element(FastTree2Config::kDepthByRule, 0u, 1u, 4u, 9u, 13u);
  c.bounds_given = *rc::gen::arbitrary<bool>();
  c.quantisers = number(1, 12);
  c.quantiser_latency = number(1, 12);
  c.queue_depth = number(1, 6);
  c.buckets = power(0, 9);
  c.combine_bytes = power(4, 7);
  c.chunk_bytes = c.combine_bytes * power(0, 4);
  c.free_chunks = number(24, 40);
  c.sub_buckets = power(1, 5);
  c.ready_buckets = number(1, 5);
  c.lanes = number(1, 5);
  c.lane_records = number(1, 60);
  c.lane_references = number(1, 200);
  c.lane_cells = power(3, 9);
  c.place_width = number(1, 8);
  c.stream_ids = number(1, 8);
  c.leaf_queue = number(1, 9);
  c.nodes_per_cycle = number(1, 4);
  c.plane_cache = power(0, 5);
  c.scene_prefetch_bytes = power(6, 11);
  c.record_prefetch_bytes = power(6, 11);
  c.write_buffer_bytes = power(7, 10);
  c.stuck_cycles = 20'000;
  return c;
}

TestMemory::Shape random_memory() {
  TestMemory::Shape shape;
  shape.access_bytes = 1u << *rc::gen::inRange(3, 8);
  shape.latency_ps = *rc::gen::inRange<std::uint64_t>(0, 300'000);
  shape.gap_ps = *rc::gen::inRange<std::uint64_t>(0, 8'000);
  shape.queue = *rc::gen::inRange<std::size_t>(1, 64);
  return shape;
}

test::OwnedMesh random_mesh() {
  const auto count = *rc::gen::inRange<std::uint32_t>(0, 400);
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  switch (*rc::gen::inRange(0, 4)) {
    case 0:
      return test::soup(count, seed, 0.05f);
    case 1:
      return test::soup(count, seed, 0.6f);
    case 2:
      return test::snapped_soup(count + 1, seed, 8);
    default: {
      // Many in one cell: a bucket that no further bit takes apart.
      test::OwnedMesh mesh = test::soup(count / 4, seed, 0.2f);
      for (std::uint32_t i = 0; i < count; ++i) {
        mesh.add({0.5f, 0.5f, 0.5f}, {0.501f, 0.5f, 0.5f}, {0.5f, 0.501f, 0.5f});
      }
      return mesh;
    }
  }
}

RC_GTEST_PROP(FastTree2, NoConfigurationChangesTheBytes, ()) {
  const test::OwnedMesh mesh = random_mesh();
  const FastTree2Config config = random_config();
  const TestMemory::Shape shape = random_memory();
  RC_ASSERT(difference(mesh.view(), config, shape) == "");
}

RC_GTEST_PROP(FastTree2, WrongBoundsAreNoticedAndGenerationIsRedone, ()) {
  const test::OwnedMesh mesh = test::soup(*rc::gen::inRange<std::uint32_t>(1, 300), 5, 0.2f);
  FastTree2Config config = random_config();
  config.bounds_given = true;
  config.depth = FastTree2Config::kDepthByRule;
  const auto edge = [] { return static_cast<float>(*rc::gen::inRange(-20, 21)) * 0.1f; };
  Extras extras;
  Box3 wrong{{edge(), edge(), edge()}, {edge(), edge(), edge()}};
  for (std::size_t a = 0; a < 3; ++a) {
    if (wrong.hi[a] < wrong.lo[a]) std::swap(wrong.hi[a], wrong.lo[a]);
  }
  extras.given_bounds = wrong;
  Figures figures;
  RC_ASSERT(difference(mesh.view(), config, random_memory(), extras, &figures) == "");
  RC_ASSERT(figures.generations == 2u);
}

TEST(FastTree2, APassThatIsAbandonedAtItsEndLeavesNothingBehind) {
  // It looks at the bounds every 64 triangles.
  const test::OwnedMesh mesh = test::soup(64, 5, 0.2f);
  for (const std::uint32_t depth : {1u, 2u, 4u, 64u}) {
    FastTree2Config config;
    config.bounds_given = true;
    config.queue_depth = depth;
    config.quantisers = 1;
    Extras extras;
    extras.given_bounds = Box3{{-2, -2, -2}, {-2, -2, -2}};
    Figures figures;
    TestMemory::Shape fast;
    fast.latency_ps = 0;
    fast.gap_ps = 0;
    EXPECT_EQ(difference(mesh.view(), config, fast, extras, &figures), "");
    EXPECT_EQ(figures.generations, 2u);
  }
}

TEST(FastTree2, RightBoundsSaveAPassOverTheScene) {
  const test::OwnedMesh mesh = test::soup(3000, 7, 0.05f);
  FastTree2Config config;
  std::uint64_t cycles[2];
  std::uint64_t bytes[2];
  for (const bool given : {false, true}) {
    config.bounds_given = given;
    TestMemory memory({});
    Figures figures;
    const auto result = run(mesh.view(), "test", config, 500, memory, {}, {}, &figures);
    ASSERT_TRUE(result.ok()) << result.status().message();
    EXPECT_EQ(figures.generations, 1u);
    cycles[given] = result.value().cycles;
    bytes[given] = result.value().memory.read_bytes;
  }
  EXPECT_EQ(bytes[false] - bytes[true], 3000u * 36u);
  EXPECT_GT(cycles[false], cycles[true] + 3000u * 36u / 64u);
}

TEST(FastTree2, PartitionsOverfullBucketsAgainAndStreamsThoseWithoutBitsThrough) {
  test::OwnedMesh mesh = test::soup(2000, 7, 0.02f);
  for (int i = 0; i < 3000; ++i) {
    mesh.add({0.5f, 0.5f, 0.5f}, {0.5001f, 0.5f, 0.5f}, {0.5f, 0.5001f, 0.5f});
  }
  FastTree2Config config;
  config.buckets = 8;
  config.lane_records = 64;
  Figures figures;
  EXPECT_EQ(difference(mesh.view(), config, {}, {}, &figures), "");
  EXPECT_GT(figures.partitions, 8u);
  EXPECT_LE(figures.most_stacked, 126u + 1u);
}

TEST(FastTree2, AccountsForEveryCycleOfEveryUnitAndEveryByte) {
  const test::OwnedMesh mesh = test::soup(2000, 9, 0.1f);
  TestMemory memory({});
  SimulationOptions options;
  options.timeline_windows = 20;
  options.keep_arrays = true;
  const auto run_result = run(mesh.view(), "test", FastTree2Config(), 500, memory, options);
  ASSERT_TRUE(run_result.ok()) << run_result.status().message();
  const SimulationResult& result = run_result.value();
  ASSERT_EQ(result.stages.size(), 3u);
  std::uint64_t read = 0;
  std::uint64_t written = 0;
  for (std::size_t s = 0; s < result.stages.size(); ++s) {
    const StageRecord& stage = result.stages[s];
    EXPECT_EQ(stage.begin_cycle, s == 0 ? 0 : result.stages[s - 1].end_cycle);
    for (const Traffic& t : stage.traffic) {
      read += t.read_bytes;
      written += t.write_bytes;
    }
    for (const UnitRecord& unit : result.units) {
      ASSERT_EQ(unit.by_stage.size(), result.stages.size());
      const Activity& a = unit.by_stage[s];
      EXPECT_EQ(a.busy_cycles + a.idle_cycles + a.stalled(), stage.end_cycle - stage.begin_cycle)
          << unit.name << " in " << stage.name;
    }
  }
  EXPECT_EQ(result.stages.back().end_cycle, result.cycles);
  EXPECT_EQ(read, result.memory.read_bytes);
  EXPECT_EQ(written, result.memory.write_bytes);

  EXPECT_GE(result.timeline.size(), 20u);
  EXPECT_LE(result.timeline.size(), 41u);
  std::uint64_t cycles = 0;
  std::uint64_t bytes = 0;
  for (const TimelineSample& sample : result.timeline) {
    EXPECT_EQ(sample.begin_cycle, cycles);
    cycles += sample.cycles;
    bytes += sample.bus_bytes;
    EXPECT_EQ(sample.busy_cycles.size(), result.units.size());
  }
  EXPECT_EQ(cycles, result.cycles);
  EXPECT_EQ(bytes, read + written);
  EXPECT_EQ(result.arrays.leaf_count.size(), result.leaves);
  EXPECT_EQ(result.arrays.sorted_ids.size(), result.references);
}

TEST(FastTree2, ASilentMemoryEndsInAReportOfWhoWaitsForWhom) {
  const test::OwnedMesh mesh = test::soup(2000, 9, 0.1f);
  FastTree2Config config;
  config.stuck_cycles = 5000;
  // In each of the stages.
  for (const std::uint64_t answers : {100u, 3000u, 6000u}) {
    TestMemory::Shape shape;
    shape.answers = answers;
    TestMemory memory(shape);
    const auto result = run(mesh.view(), "test", config, 500, memory, {});
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.status().code(), StatusCode::resource_limit);
    EXPECT_NE(result.status().message().find("is stuck"), std::string::npos);
    EXPECT_NE(result.status().message().find("dma waits for memory"), std::string::npos)
        << result.status().message();
  }
}

TEST(FastTree2, ALostAccessEndsInAReportOfWhoWaitsForWhom) {
  const test::OwnedMesh mesh = test::soup(500, 9, 0.1f);
  FastTree2Config config;
  config.stuck_cycles = 5000;
  TestMemory memory({});
  Extras extras;
  extras.faults.lost_beat = 17;
  const auto result = run(mesh.view(), "test", config, 500, memory, {}, extras);
  ASSERT_FALSE(result.ok());
  EXPECT_NE(
      result.status().message().find("scene_reader waits for memory for the bytes of triangle"),
      std::string::npos)
      << result.status().message();
}

TEST(FastTree2, ADroppedRecordIsNoticed) {
  const test::OwnedMesh mesh = test::soup(500, 9, 0.1f);
  for (const std::uint64_t record : {0u, 123u, 499u}) {
    Extras extras;
    extras.faults.drop_record = record;
    const std::string what = difference(mesh.view(), FastTree2Config(), {}, extras);
    EXPECT_NE(what.find("references were counted and never placed"), std::string::npos) << what;
  }
}

TEST(FastTree2, AWrongChunkLinkIsNoticed) {
  const test::OwnedMesh mesh = test::soup(2000, 9, 0.1f);
  FastTree2Config config;
  config.buckets = 8;
  config.chunk_bytes = 256;
  EXPECT_EQ(difference(mesh.view(), config), "");
  for (const std::uint64_t link : {0u, 5u, 20u}) {
    Extras extras;
    extras.faults.wrong_link = link;
    EXPECT_NE(difference(mesh.view(), config, {}, extras), "") << link;
  }
}

TEST(FastTree2, IsCancelledByItsCallbackAndEndsAtItsLimit) {
  const test::OwnedMesh mesh = test::soup(60'000, 9, 0.01f);
  SimulationOptions options;
  int calls = 0;
  double last = 0;
  options.progress = [&](const char*, double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
    return ++calls < 3;
  };
  TestMemory memory({});
  const auto cancelled = run(mesh.view(), "test", FastTree2Config(), 500, memory, options);
  EXPECT_EQ(cancelled.status().code(), StatusCode::cancelled);
  EXPECT_EQ(calls, 3);

  TestMemory other({});
  options = {};
  options.max_cycles = 10'000;
  const auto limited = run(mesh.view(), "test", FastTree2Config(), 500, other, options);
  EXPECT_EQ(limited.status().code(), StatusCode::resource_limit);
}

TEST(FastTree2, RefusesBadInputAndConfigurations) {
  test::OwnedMesh mesh = test::soup(10, 9, 0.1f);
  FastTree2Config config;
  config.chunk_bytes = 32;
  TestMemory memory({});
  EXPECT_EQ(run(mesh.view(), "test", config, 500, memory, {}).status().code(),
            StatusCode::invalid_argument);
  mesh.positions[7].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(run(mesh.view(), "test", FastTree2Config(), 500, memory, {}).status().code(),
            StatusCode::bad_input);
}

TEST(FastTree2, RefusesASceneThatItsMemoryDoesNotHold) {
  const test::OwnedMesh mesh = test::soup(20000, 8, 0.02f);
  MachineConfig config = load_config("fasttree-2").value();
  EXPECT_TRUE(simulate_fasttree2(mesh.view(), config, {}).ok());
  config.memory.dram.rows = 1;
  EXPECT_EQ(simulate_fasttree2(mesh.view(), config, {}).status().code(),
            StatusCode::resource_limit);
}

}  // namespace
}  // namespace fasttree::model::ft2
