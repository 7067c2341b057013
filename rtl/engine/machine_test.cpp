// SPDX-License-Identifier: Apache-2.0
// The verilated accelerator as a whole: every array against the reference builder's, with every
// kind of memory; and what it refuses.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "fasttree/device_image.h"
#include "model/memory/make_memory.h"
#include "model/system/compare_reference.h"
#include "model/system/host_interface.h"
#include "model/system/paper_machine.h"
#include "model/system/pipe_memory.h"
#include "rtl/engine/board.h"
#include "rtl/engine/rtl_machine.h"
#include "rtl/engine/variants.h"
#include "tests/support/meshes.h"

namespace fasttree::rtl {
namespace {

using model::MachineConfig;
using model::SimulationOptions;
using model::SimulationResult;
using model::test::PipeMemory;
using model::test::PipeSettings;

MachineConfig machine(std::size_t variant = 0) {
  MachineConfig config;
  config.name = "test";
  config.clock_mhz = 163;
  for (const std::string& key : variants()[variant].keys) {
    EXPECT_TRUE(apply_override(config, "paper." + key).ok()) << key;
  }
  return config;
}

Result<SimulationResult> simulate(const MeshView& mesh, const MachineConfig& config,
                                  const RtlOptions& rtl = {}, const PipeSettings& pipe = {}) {
  PipeMemory memory(pipe);
  SimulationOptions options;
  options.keep_arrays = true;
  return simulate_rtl(mesh, config, options, rtl, memory);
}

std::string difference(const MeshView& mesh, const MachineConfig& config,
                       const SimulationResult& result) {
  return model::test::difference(mesh, config.paper, result);
}

TEST(RtlMachine, MakesTheReferencesArraysOfEveryDegenerateMesh) {
  for (std::size_t v = 0; v < variants().size(); ++v) {
    for (const auto& [name, owned] : fasttree::test::degenerate_meshes()) {
      for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
        SCOPED_TRACE(variants()[v].name + ", " + name + ", " + to_string(axes));
        MachineConfig config = machine(v);
        config.paper.grid.axes = axes;
        const Result<SimulationResult> result = simulate(owned.view(), config);
        ASSERT_TRUE(result.ok()) << result.status().message();
        EXPECT_EQ(difference(owned.view(), config, result.value()), "");
      }
    }
  }
}

TEST(RtlMachine, BuildsTheEmptyScene) {
  const Result<SimulationResult> result = simulate(MeshView{}, machine());
  ASSERT_TRUE(result.ok()) << result.status().message();
  EXPECT_EQ(result.value().tree.hash(), Tree().hash());
  EXPECT_EQ(result.value().leaves, 0u);
}

PipeSettings random_pipe(fasttree::test::Random& random) {
  PipeSettings pipe;
  pipe.access_bytes = 8u << random.below(4);
  pipe.latency_ps = random.below(200000);
  pipe.jitter_ps = random.below(2) * random.below(100000);
  pipe.queue = 1 + random.below(70);
  return pipe;
}

/// Memories that are slow, deal with few accesses at once, answer out of order, and stall.
TEST(RtlMachine, MakesTheReferencesArraysOfAThousandRandomScenes) {
  fasttree::test::Random random(2014);
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const fasttree::test::OwnedMesh mesh =
        fasttree::test::soup(random.below(60), random.below(1u << 30),
                             std::vector<float>{0.02f, 0.2f, 1.0f}[random.below(3)]);
    MachineConfig config = machine(random.below(static_cast<std::uint32_t>(variants().size())));
    config.paper.grid.axes = random.below(2) ? AxisSchedule::cyclic : AxisSchedule::longest;
    config.paper.grid.depth_fixed = random.below(2) != 0;
    config.paper.grid.depth = random.below(11);
    config.paper.radix_sort.sorted_bits = 12 + random.below(21);
    config.clock_mhz = std::vector<double>{50, 163, 500, 1234.5}[random.below(4)];
    RtlOptions rtl;
    rtl.wild_seed = random.below(4) == 0 ? 0 : 1 + random.below(1u << 30);
    const Result<SimulationResult> result = simulate(mesh.view(), config, rtl, random_pipe(random));
    ASSERT_TRUE(result.ok()) << result.status().message();
    ASSERT_EQ(difference(mesh.view(), config, result.value()), "");
  }
}

TEST(RtlMachine, MakesTheSameBytesWithEveryMemory) {
  const fasttree::test::OwnedMesh mesh = fasttree::test::soup(1500, 8, 0.05f);
  SimulationOptions options;
  options.keep_arrays = true;
  for (const std::string& preset : model::memory_presets()) {
    MachineConfig config = machine();
    config.memory = model::memory_preset(preset).value();
    const Result<SimulationResult> result = simulate_rtl(mesh.view(), config, options);
    ASSERT_TRUE(result.ok()) << preset << ": " << result.status().message();
    EXPECT_EQ(difference(mesh.view(), config, result.value()), "") << preset;
  }
}

const fasttree::test::OwnedMesh& soup() {
  static const fasttree::test::OwnedMesh mesh = fasttree::test::soup(2000, 8, 0.05f);
  return mesh;
}

double ratio(std::uint64_t a, std::uint64_t b) {
  return static_cast<double>(a) / static_cast<double>(b);
}

/// The model predicts the RTL: cycles in all and by stage, the cache's hits, and the bytes moved.
TEST(RtlMachine, TakesTheCyclesThatTheModelPredicts) {
  const fasttree::test::OwnedMesh mesh = fasttree::test::soup(8000, 3, 0.03f);
  for (std::size_t v = 0; v < variants().size(); ++v) {
    for (const char* preset : {"ddr3-1600", "lpddr3-1600-dual"}) {
      SCOPED_TRACE(variants()[v].name + ", " + preset);
      MachineConfig config = machine(v);
      config.memory = model::memory_preset(preset).value();
      const SimulationResult rtl = simulate_rtl(mesh.view(), config, {}).value();
      const SimulationResult predicted = simulate_paper(mesh.view(), config, {}).value();
      EXPECT_NEAR(ratio(predicted.cycles, rtl.cycles), 1, 0.03);
      ASSERT_EQ(rtl.stages.size(), predicted.stages.size());
      for (std::size_t s = 0; s < rtl.stages.size(); ++s) {
        const auto& a = predicted.stages[s];
        const auto& b = rtl.stages[s];
        EXPECT_EQ(a.name, b.name);
        EXPECT_NEAR(ratio(a.end_cycle - a.begin_cycle, b.end_cycle - b.begin_cycle), 1, 0.10)
            << a.name;
        ASSERT_EQ(a.traffic.size(), b.traffic.size()) << a.name;
        for (std::size_t t = 0; t < a.traffic.size(); ++t) {
          EXPECT_EQ(a.traffic[t].purpose, b.traffic[t].purpose) << a.name;
          // A stream's last beat is read whole; the sort has eight streams.
          EXPECT_NEAR(ratio(a.traffic[t].read_bytes, 8 * config.paper.bus.bytes),
                      ratio(b.traffic[t].read_bytes, 8 * config.paper.bus.bytes), 1)
              << a.name;
          EXPECT_EQ(a.traffic[t].write_bytes, b.traffic[t].write_bytes) << a.name;
        }
      }
      EXPECT_EQ(predicted.mark_cache.read_hits, rtl.mark_cache.read_hits);
      EXPECT_EQ(predicted.mark_cache.write_backs, rtl.mark_cache.write_backs);
    }
  }
}

TEST(RtlMachine, AccountsForEveryCycleOfEveryUnit) {
  const SimulationResult result = simulate(soup().view(), machine()).value();
  ASSERT_EQ(result.stages.size(), 6u);
  for (std::size_t s = 0; s < 6; ++s) {
    const model::StageRecord& stage = result.stages[s];
    for (const model::UnitRecord& unit : result.units) {
      const model::Activity& a = unit.by_stage[s];
      EXPECT_EQ(a.busy_cycles + a.idle_cycles + a.stalled(), stage.end_cycle - stage.begin_cycle)
          << unit.name << " in " << stage.name;
    }
  }
  // Who has the work of a stage is busy in it.
  const auto busy = [&](const char* name, std::size_t stage) {
    for (const model::UnitRecord& unit : result.units) {
      if (unit.name == name) return unit.by_stage[stage].busy_cycles;
    }
    return std::uint64_t{0};
  };
  EXPECT_GT(busy("scene_reader", 0), 4000u);
  EXPECT_GT(busy("sbcu_upper", 0), 2000u);
  EXPECT_GT(busy("mcgu3", 1), 4000u);
  EXPECT_GT(busy("psu0", 2), 1000u);
  EXPECT_GT(busy("rsu", 2), 10000u);
  EXPECT_GT(busy("lngu", 3), 500u);
  EXPECT_GT(busy("ingu", 4), 1000u);
  EXPECT_GT(busy("split_plane", 4), 500u);
  EXPECT_GT(busy("beu", 4), 100u);
  EXPECT_GT(busy("pcu", 5), 1000u);
  EXPECT_GT(busy("mark_cache", 5), 500u);
  EXPECT_EQ(busy("pcu", 2), 0u);
}

// ---- What it refuses.

StatusCode code_of(const RtlOptions& rtl, std::string* message = nullptr,
                   const PipeSettings& pipe = {}) {
  const Result<SimulationResult> result = simulate(soup().view(), machine(), rtl, pipe);
  if (message != nullptr) *message = result.ok() ? "" : result.status().message();
  return result.ok() ? StatusCode::ok : result.status().code();
}

TEST(RtlMachine, RefusesACoordinateThatIsNotFinite) {
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()}) {
    for (const std::uint32_t at : {0u, 8u, 4711u, 17999u}) {
      RtlOptions rtl;
      rtl.tamper = [&](ft_accel_order& order, model::ByteStore& store) {
        store.write(model::Address(order.scene + at * 4), &value, 4);
      };
      std::string message;
      EXPECT_EQ(code_of(rtl, &message), StatusCode::bad_input);
      EXPECT_NE(message.find("coordinate " + std::to_string(at % 9) + " of triangle " +
                             std::to_string(at / 9)),
                std::string::npos)
          << message;
    }
  }
}

TEST(RtlMachine, RefusesWhatDoesNotFit) {
  const auto refused = [](void (*change)(ft_accel_order&)) {
    RtlOptions rtl;
    rtl.tamper = [change](ft_accel_order& order, model::ByteStore&) { change(order); };
    std::string message;
    const StatusCode code = code_of(rtl, &message);
    EXPECT_NE(code, StatusCode::ok);
    return message;
  };
  const auto has = [](const std::string& text, const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(refused([](ft_accel_order& o) { o.scene_bytes = 36 * 2000 - 1; }), "larger than its buffer");
  has(refused([](ft_accel_order& o) { o.triangles = 0xffffffff; }), "larger than its buffer");
  // 36 bytes each, that is 32 more than 2^32.
  has(refused([](ft_accel_order& o) { o.triangles = 119304648; }), "larger than its buffer");
  has(refused([](ft_accel_order& o) { o.reference_capacity = 2100; }), "more references than");
  has(refused([](ft_accel_order& o) { o.leaf_capacity = 100; }), "more leaves than");
  has(refused([](ft_accel_order& o) { o.window_begin = 64; }), "outside its window");
  has(refused([](ft_accel_order& o) { o.window_end = o.nodes + 64; }), "outside its window");
  has(refused([](ft_accel_order& o) { o.window_end = o.pairs1; }), "outside its window");
  has(refused([](ft_accel_order& o) { o.shape = 31; }), "word 1 ");
  has(refused([](ft_accel_order& o) { o.leaf_rows += 64; }), "word 9 ");
  has(refused([](ft_accel_order& o) { o.mark_bytes /= 2; }), "word 14 ");
  has(refused([](ft_accel_order& o) { o.rounds = 2; }), "word 15 ");
  has(refused([](ft_accel_order& o) { o.rounds = 9; }), "word 15 ");
}

/// Nothing outside the window is written, whatever the order says: a build over a pattern.
TEST(RtlMachine, WritesNothingOutsideItsWindowOrPastItsRoom) {
  for (const std::uint32_t capacity : {1u, 500u, 2500u, 1u << 20}) {
    for (const std::uint32_t leaf_capacity : {1u, 77u, 1u << 20}) {
      ft_accel_order seen{};
      const model::ByteStore* memory = nullptr;
      std::vector<std::uint8_t> before;
      RtlOptions rtl;
      rtl.tamper = [&](ft_accel_order& order, model::ByteStore& store) {
        order.reference_capacity = std::min(order.reference_capacity, capacity);
        order.leaf_capacity = std::min(order.leaf_capacity, leaf_capacity);
        seen = order;
        memory = &store;
        before.resize(store.size());
        store.read(model::Address(0), before.data(), before.size());
      };
      rtl.inspect = [&](const model::ByteStore& store) {
        std::vector<std::uint8_t> after(store.size());
        store.read(model::Address(0), after.data(), after.size());
        const auto untouched = [&](std::uint64_t from, std::uint64_t to) {
          return std::memcmp(before.data() + from, after.data() + from, to - from) == 0;
        };
        EXPECT_TRUE(untouched(0, seen.pairs0)) << "the scene";
        const std::uint64_t n = seen.reference_capacity;
        const std::uint64_t l = seen.leaf_capacity;
        EXPECT_TRUE(untouched(seen.pairs0 + 8 * n, seen.pairs1));
        EXPECT_TRUE(untouched(seen.pairs1 + 8 * n, seen.sorted_codes));
        EXPECT_TRUE(untouched(seen.sorted_codes + 4 * n, seen.sorted_ids));
        EXPECT_TRUE(untouched(seen.sorted_ids + 4 * n, seen.leaf_codes));
        EXPECT_TRUE(untouched(seen.leaf_codes + 4 * l, seen.leaf_rows));
        EXPECT_TRUE(untouched(seen.leaf_rows + 8 * l, seen.marks));
        EXPECT_TRUE(untouched(seen.marks + seen.mark_bytes, seen.nodes));
        EXPECT_TRUE(untouched(seen.nodes + 16 * l, store.size()));
      };
      const bool fits = capacity == 1u << 20 && leaf_capacity == 1u << 20;
      EXPECT_EQ(code_of(rtl) == StatusCode::ok, fits);
      EXPECT_NE(memory, nullptr) << "looked at nothing";
    }
  }
}

TEST(RtlMachine, EndsWhereMemoryAnswersWithErrorsOrNotAtAll) {
  for (const std::uint64_t n : {1u, 100u, 3000u}) {
    RtlOptions rtl;
    std::string message;
    rtl.spoil = [n](AxiMemory& memory) { memory.fail_read(n); };
    EXPECT_EQ(code_of(rtl, &message), StatusCode::io_error) << message;
    rtl.spoil = [n](AxiMemory& memory) { memory.fail_write(n); };
    EXPECT_EQ(code_of(rtl, &message), StatusCode::io_error) << message;
  }
  PipeSettings pipe;
  pipe.stops_after = 5000;
  std::string message;
  EXPECT_EQ(code_of({}, &message, pipe), StatusCode::resource_limit);
  EXPECT_NE(message.find("stuck"), std::string::npos) << message;
}

TEST(RtlMachine, CanBeCancelledAndBounded) {
  PipeMemory memory({});
  SimulationOptions options;
  options.progress = [](const char*, double) { return false; };
  EXPECT_EQ(simulate_rtl(soup().view(), machine(), options, {}, memory).status().code(),
            StatusCode::cancelled);
  PipeMemory second({});
  options.progress = nullptr;
  options.max_cycles = 10000;
  EXPECT_EQ(simulate_rtl(soup().view(), machine(), options, {}, second).status().code(),
            StatusCode::resource_limit);
}

TEST(RtlMachine, RefusesASceneThatItsMemoryDoesNotHold) {
  MachineConfig config = machine();
  EXPECT_TRUE(simulate_rtl(soup().view(), config, {}).ok());
  config.memory.dram.rows = 1;
  EXPECT_EQ(simulate_rtl(soup().view(), config, {}).status().code(), StatusCode::resource_limit);
}

TEST(RtlMachine, SaysForWhichConfigurationsItWasBuilt) {
  MachineConfig config = machine();
  ASSERT_TRUE(apply_override(config, "paper.mark_cache_ways=8").ok());
  const Status status = simulate_rtl(soup().view(), config, {}).status();
  EXPECT_EQ(status.code(), StatusCode::invalid_argument);
  EXPECT_NE(status.message().find("paper.mark_cache_ways = 16, not 8"), std::string::npos)
      << status.message();
}

}  // namespace
}  // namespace fasttree::rtl
