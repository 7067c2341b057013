// SPDX-License-Identifier: Apache-2.0
#include "model/system/paper_machine.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>

#include "model/system/compare_reference.h"
#include "model/system/pipe_memory.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

using test::PipeMemory;
using test::PipeSettings;

MachineConfig machine() {
  MachineConfig config;
  config.name = "test";
  config.clock_mhz = 163;
  return config;
}

Result<SimulationResult> simulate(const MeshView& mesh, const MachineConfig& config,
                                  const TestHooks& hooks = {}, const PipeSettings& pipe = {}) {
  PipeMemory memory(pipe);
  SimulationOptions options;
  options.keep_arrays = true;
  return simulate_paper(mesh, config, options, memory, hooks);
}

TEST(PaperMachine, MakesTheReferencesArraysOfEveryDegenerateMesh) {
  for (const auto& [name, owned] : fasttree::test::degenerate_meshes()) {
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      SCOPED_TRACE(name + std::string(", ") + to_string(axes));
      MachineConfig config = machine();
      config.paper.grid.axes = axes;
      const Result<SimulationResult> result = simulate(owned.view(), config);
      ASSERT_TRUE(result.ok()) << result.status().message();
      EXPECT_EQ(test::difference(owned.view(), config.paper, result.value()), "");
    }
  }
}

TEST(PaperMachine, BuildsTheEmptyScene) {
  const Result<SimulationResult> result = simulate(MeshView{}, machine());
  ASSERT_TRUE(result.ok()) << result.status().message();
  EXPECT_EQ(result.value().tree.hash(), Tree().hash());
  EXPECT_EQ(result.value().leaves, 0u);
}

PaperConfig random_config() {
  const auto upto = [](std::uint32_t most) { return *rc::gen::inRange(1u, most + 1); };
  const auto power = [](int least, int most) { return 1u << *rc::gen::inRange(least, most + 1); };
  PaperConfig c;
  c.grid.axes = *rc::gen::element(AxisSchedule::cyclic, AxisSchedule::longest);
  c.grid.extra_depth = *rc::gen::inRange(0u, 4u);
  c.grid.depth_fixed = *rc::gen::arbitrary<bool>();
  c.grid.depth = *rc::gen::inRange(0u, 13u);
  c.scene_bound.inputs = power(1, 4);
  c.scene_bound.queue = upto(3);
  c.morton_code.units = upto(6);
  c.morton_code.quantisers = upto(6);
  c.morton_code.quantiser_latency = upto(9);
  c.morton_code.box_latency = upto(3);
  c.morton_code.input_queue = upto(3);
  c.morton_code.output_queue = upto(20);
  c.morton_code.pairs_per_cycle = upto(4);
  c.morton_code.combine_bytes = power(3, 6);
  c.prefix_sum.units = upto(6);
  c.prefix_sum.section = power(1, 6);
  c.prefix_sum.stages = 1 + upto(6);
  c.radix_sort.radix_bits = upto(8);
  c.radix_sort.sorted_bits = *rc::gen::inRange(22u, 33u);
  c.radix_sort.key_bytes = *rc::gen::inRange(3u, 5u);
  c.radix_sort.digit_count = *rc::gen::element(DigitCount::on_the_way, DigitCount::own_pass);
  c.radix_sort.double_buffer = *rc::gen::arbitrary<bool>();
  c.radix_sort.pairs_per_cycle = upto(4);
  c.radix_sort.combine_bytes = power(3, 6);
  c.leaf_node.width = upto(70);
  c.leaf_node.pool = upto(100);
  c.leaf_node.rows_per_cycle = upto(4);
  c.internal_node.shifts_per_cycle = upto(32);
  c.internal_node.plane_cycles = upto(5);
  c.internal_node.plane_latency = upto(40);
  c.internal_node.queue = upto(5);
  c.path_compression.step_cycles = upto(4);
  c.mark_cache.block_bytes = power(2, 6);
  c.mark_cache.ways = power(0, 4);
  c.mark_cache.bytes = std::max(64u, c.mark_cache.block_bytes * c.mark_cache.ways * power(0, 5));
  c.mark_cache.hit_latency = upto(5);
  c.mark_cache.miss_penalty = *rc::gen::inRange(0u, 5u);
  c.mark_cache.write_back = *rc::gen::arbitrary<bool>();
  c.bus.bytes = power(2, 6);
  c.bus.duplex = *rc::gen::arbitrary<bool>();
  c.bus.commands_per_cycle = upto(4);
  c.bus.burst_bytes = power(3, 6);
  c.bus.read_ahead_bytes = *rc::gen::inRange(128u, 1000u);
  c.bus.request_queue = 3 + upto(8);
  c.bus.reads_in_flight = upto(20);
  c.control.step_cycles = *rc::gen::inRange(0u, 20u);
  return c;
}

PipeSettings random_pipe() {
  PipeSettings pipe;
  pipe.access_bytes = 8u << *rc::gen::inRange(0, 4);
  pipe.latency_ps = *rc::gen::inRange<std::uint64_t>(0, 200000);
  pipe.jitter_ps = *rc::gen::inRange<std::uint64_t>(0, 100000);
  pipe.queue = *rc::gen::inRange<std::size_t>(1, 70);
  return pipe;
}

fasttree::test::OwnedMesh random_mesh() {
  const auto triangles = *rc::gen::inRange(0u, 120u);
  const float size = *rc::gen::element(0.02f, 0.2f, 1.0f);
  return fasttree::test::soup(triangles, *rc::gen::inRange<std::uint64_t>(1, 1000), size);
}

/// No width, depth, count, policy or latency changes a byte of any array.
RC_GTEST_PROP(PaperMachine, MakesTheSameBytesInEveryConfiguration, ()) {
  const fasttree::test::OwnedMesh mesh = random_mesh();
  MachineConfig config = machine();
  config.clock_mhz = *rc::gen::element(50.0, 163.0, 500.0, 1234.5);
  config.paper = random_config();
  const Result<SimulationResult> result = simulate(mesh.view(), config, {}, random_pipe());
  if (!result.ok()) RC_FAIL(result.status().message());
  RC_ASSERT(test::difference(mesh.view(), config.paper, result.value()) == "");
}

/// Cycles, traffic and every unit's account do not depend on who is ticked first.
RC_GTEST_PROP(PaperMachine, TakesTheSameCyclesInEveryOrderOfItsUnits, ()) {
  const fasttree::test::OwnedMesh mesh = random_mesh();
  MachineConfig config = machine();
  config.paper = random_config();
  const PipeSettings pipe = random_pipe();
  const SimulationResult first = simulate(mesh.view(), config, {}, pipe).value();
  TestHooks hooks;
  hooks.tick_order = *rc::gen::inRange(1u, 100000u);
  const SimulationResult second = simulate(mesh.view(), config, hooks, pipe).value();
  RC_ASSERT(first.cycles == second.cycles);
  RC_ASSERT(first.tree.hash() == second.tree.hash());
  for (std::size_t u = 0; u < first.units.size(); ++u) {
    for (std::size_t s = 0; s < first.stages.size(); ++s) {
      const Activity& a = first.units[u].by_stage[s];
      const Activity& b = second.units[u].by_stage[s];
      RC_ASSERT(a.busy_cycles == b.busy_cycles);
      RC_ASSERT(a.stalled_cycles == b.stalled_cycles);
    }
  }
}

/// Real memories as well: latencies that depend on addresses, refresh, reordering.
TEST(PaperMachine, MakesTheSameBytesWithEveryMemory) {
  const fasttree::test::OwnedMesh mesh = fasttree::test::soup(3000, 8, 0.05f);
  SimulationOptions options;
  options.keep_arrays = true;
  std::uint64_t ideal = 0;
  for (const std::string& preset : memory_presets()) {
    MachineConfig config = machine();
    config.memory = memory_preset(preset).value();
    const Result<SimulationResult> result = simulate_paper(mesh.view(), config, options);
    ASSERT_TRUE(result.ok()) << preset << ": " << result.status().message();
    EXPECT_EQ(test::difference(mesh.view(), config.paper, result.value()), "") << preset;
    EXPECT_EQ(result.value().memory_traits.name, preset);
    if (preset == "ideal") ideal = result.value().cycles;
    EXPECT_GE(result.value().cycles, ideal) << preset;
  }
  EXPECT_GT(ideal, 0u);
}

const fasttree::test::OwnedMesh& soup() {
  static const fasttree::test::OwnedMesh mesh = fasttree::test::soup(2000, 8, 0.05f);
  return mesh;
}

TEST(PaperMachine, AccountsForEveryCycleOfEveryUnit) {
  const SimulationResult result = simulate(soup().view(), machine()).value();
  ASSERT_EQ(result.stages.size(), 6u);
  EXPECT_EQ(result.stages.front().begin_cycle, 0u);
  EXPECT_EQ(result.stages.back().end_cycle, result.cycles);
  std::uint64_t bytes = 0;
  for (std::size_t s = 0; s < 6; ++s) {
    const StageRecord& stage = result.stages[s];
    if (s > 0) {
      EXPECT_EQ(stage.begin_cycle, result.stages[s - 1].end_cycle);
    }
    for (const UnitRecord& unit : result.units) {
      ASSERT_EQ(unit.by_stage.size(), 6u);
      const Activity& a = unit.by_stage[s];
      EXPECT_EQ(a.busy_cycles + a.idle_cycles + a.stalled(), stage.end_cycle - stage.begin_cycle)
          << unit.name << " in " << stage.name;
    }
    for (const Traffic& traffic : stage.traffic) bytes += traffic.read_bytes + traffic.write_bytes;
  }
  EXPECT_EQ(bytes, result.memory.read_bytes + result.memory.write_bytes);
  // Two readings of the scene, and the sort's seven rounds of pairs and one of codes and ids.
  const std::uint64_t pairs = 8 * result.references;
  EXPECT_EQ(result.stages[0].traffic[0].read_bytes, 36u * 2000);
  EXPECT_EQ(result.stages[1].traffic[1].write_bytes, pairs);
  EXPECT_EQ(result.stages[2].traffic[0].read_bytes, 8 * pairs);
  EXPECT_EQ(result.stages[2].traffic[0].write_bytes, 7 * pairs);

  ASSERT_GE(result.timeline.size(), 100u);
  std::uint64_t cycle = 0;
  std::vector<std::uint64_t> busy(result.units.size());
  std::uint64_t moved = 0;
  for (const TimelineSample& sample : result.timeline) {
    EXPECT_EQ(sample.begin_cycle, cycle);
    cycle += sample.cycles;
    moved += sample.bus_bytes;
    for (std::size_t u = 0; u < busy.size(); ++u) busy[u] += sample.busy_cycles[u];
  }
  EXPECT_EQ(cycle, result.cycles);
  EXPECT_EQ(moved, bytes);
  for (std::size_t u = 0; u < busy.size(); ++u) {
    std::uint64_t expected = 0;
    for (const Activity& a : result.units[u].by_stage) expected += a.busy_cycles;
    EXPECT_EQ(busy[u], expected) << result.units[u].name;
  }
}

TEST(PaperMachine, ReportsWhoWaitsForWhomWhereAUnitIsDead) {
  for (const auto& [unit, waiting] : std::vector<std::pair<std::string, std::string>>{
           {"bus", "scene_reader waits for 72000 bytes of the scene from the bus"},
           {"sbcu_upper", "scene_reader waits for scene_bound to take coordinates"},
           {"mcgu1", "pair_writer waits for pairs of mcgu1"},
           {"psu2", "rsu waits for prefix_sum to give a section's sums, round 1"},
           {"beu", "nothing"},
           {"mark_cache", "beu waits for"},
           {"pcu", "nothing"}}) {
    TestHooks hooks;
    hooks.dead_unit = unit;
    const Status status = simulate(soup().view(), machine(), hooks).status();
    EXPECT_EQ(status.code(), StatusCode::resource_limit) << unit;
    EXPECT_NE(status.message().find("stuck"), std::string::npos) << status.message();
    EXPECT_NE(status.message().find(waiting), std::string::npos) << status.message();
  }
}

TEST(PaperMachine, ReportsAMemoryThatNoLongerAnswers) {
  PipeSettings pipe;
  pipe.stops_after = 20000;
  const Status status = simulate(soup().view(), machine(), {}, pipe).status();
  EXPECT_NE(status.message().find("bus waits for memory, which waits for its latency"),
            std::string::npos)
      << status.message();
}

/// Wherever a beat is lost, the run ends, and never with the right arrays. With as many rounds as
/// codes have digits: a round over bits that are all zero writes what lies there already.
TEST(PaperMachine, ALostBeatIsNoticed) {
  MachineConfig config = machine();
  config.paper.radix_sort.sorted_bits = 12;
  const SimulationResult whole = simulate(soup().view(), config).value();
  ASSERT_EQ(whole.units[0].name, "bus");
  std::uint64_t beats = 0;
  for (const Activity& activity : whole.units[0].by_stage) beats += activity.busy_cycles;
  ASSERT_GT(beats, 10000u);
  int stuck = 0;
  int wrong = 0;
  for (std::uint64_t beat = 1; beat <= beats; beat += beats / 61) {
    TestHooks hooks;
    hooks.drop_beat = beat;
    const Result<SimulationResult> result = simulate(soup().view(), config, hooks);
    if (!result.ok()) {
      // Where pairs are missing, what lay there before is no code, and the image no tree.
      ++(result.status().message().find("stuck") != std::string::npos ? stuck : wrong);
      continue;
    }
    EXPECT_NE(test::difference(soup().view(), config.paper, result.value()), "") << beat;
    ++wrong;
  }
  EXPECT_GT(stuck, 20) << "a read waits for ever";
  EXPECT_GT(wrong, 20) << "a write is missing";
}

TEST(PaperMachine, AWrongVictimShowsInTheCachesHits) {
  MachineConfig config = machine();
  config.paper.mark_cache.bytes = 128;
  TestHooks hooks;
  hooks.wrong_victim = true;
  const SimulationResult right = simulate(soup().view(), config).value();
  const SimulationResult broken = simulate(soup().view(), config, hooks).value();
  EXPECT_EQ(right.tree.hash(), broken.tree.hash()) << "what is evicted is written back";
  EXPECT_NE(right.mark_cache.read_hits, broken.mark_cache.read_hits);
  EXPECT_GT(broken.cycles, right.cycles);
}

TEST(PaperMachine, CanBeCancelledAndBounded) {
  PipeMemory memory({});
  SimulationOptions options;
  int reports = 0;
  double last = 0;
  options.progress = [&](const char*, double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
    ++reports;
    return true;
  };
  const fasttree::test::OwnedMesh mesh = fasttree::test::soup(20000, 8, 0.02f);
  ASSERT_TRUE(simulate_paper(mesh.view(), machine(), options, memory).ok());
  EXPECT_GT(reports, 3);
  PipeMemory second({});
  options.progress = [](const char*, double) { return false; };
  EXPECT_EQ(simulate_paper(mesh.view(), machine(), options, second).status().code(),
            StatusCode::cancelled);
  PipeMemory third({});
  options.progress = nullptr;
  options.max_cycles = 10000;
  EXPECT_EQ(simulate_paper(mesh.view(), machine(), options, third).status().code(),
            StatusCode::resource_limit);
}

TEST(PaperMachine, RefusesWhatItCannotBuild) {
  MachineConfig config = machine();
  config.paper.control.memory_mbytes = 1;
  const fasttree::test::OwnedMesh mesh = fasttree::test::soup(20000, 8, 0.02f);
  EXPECT_EQ(simulate(mesh.view(), config).status().code(), StatusCode::resource_limit);
  config = machine();
  EXPECT_TRUE(simulate_paper(mesh.view(), config, SimulationOptions()).ok());
  config.memory.dram.rows = 1;
  EXPECT_EQ(simulate_paper(mesh.view(), config, SimulationOptions()).status().code(),
            StatusCode::resource_limit);
  config = machine();
  config.paper.radix_sort.sorted_bits = 8;
  EXPECT_EQ(simulate(mesh.view(), config).status().code(), StatusCode::invalid_argument);
  config = machine();
  config.paper.mark_cache.bytes = 64;
  EXPECT_EQ(simulate(mesh.view(), config).status().code(), StatusCode::invalid_argument);
  fasttree::test::OwnedMesh bad = soup();
  bad.positions[7].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(simulate(bad.view(), machine()).status().code(), StatusCode::bad_input);
}

}  // namespace
}  // namespace fasttree::model
