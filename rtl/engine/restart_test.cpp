// SPDX-License-Identifier: Apache-2.0
// One verilated accelerator, many builds: each right, whatever came before it or meanwhile.
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <vector>

#include "fasttree/device_image.h"
#include "model/system/host_interface.h"
#include "model/system/pipe_memory.h"
#include "rtl/engine/board.h"
#include "rtl/engine/rtl_machine.h"
#include "rtl/engine/variants.h"
#include "tests/support/meshes.h"

namespace fasttree::rtl {
namespace {

using model::test::PipeMemory;
using model::test::PipeSettings;

/// Whatever ended the build before (an error, a cancel at any moment), the next one is right, and
/// so is one during which another is ordered.
TEST(RtlMachine, GoesOnAfterWhateverHasEndedABuild) {
  const fasttree::test::OwnedMesh mesh = fasttree::test::soup(300, 5, 0.1f);
  model::MachineConfig config;
  config.clock_mhz = 163;
  for (const std::string& key : variants().front().keys) {
    ASSERT_TRUE(apply_override(config, "paper." + key).ok()) << key;
  }
  const model::HostOrder host = model::prepare_order(mesh.view(), config.paper).value();
  ft_accel_order order{};
  ASSERT_NE(ft_accel_plan(&order, 0, host.triangles, static_cast<std::uint32_t>(host.references),
                          static_cast<std::uint32_t>(host.depth)),
            0u);
  model::ByteStore store(order.window_end);
  model::MemoryMap map;
  map.scene = model::Address(order.scene);
  model::write_scene(mesh.view(), map, store);
  std::vector<std::uint32_t> expected;

  PipeSettings pipe;
  pipe.jitter_ps = 30000;
  PipeMemory memory(pipe);
  AxiMemoryOptions axi_options;
  axi_options.bus_bytes = config.paper.bus.bytes;
  axi_options.wild = true;
  AxiMemory axi(memory, store, axi_options);
  const std::unique_ptr<Top> top = variants().front().make();
  Board board(*top, axi, config, 0, nullptr);
  ft_accel device = board.driver();
  ASSERT_EQ(ft_accel_probe(&device), 0);
  fasttree::test::Random random(7);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    ft_accel_order now = order;
    const bool spoilt = i % 2 == 1;
    const std::uint32_t kind = spoilt ? random.below(5) : 5;
    if (kind == 0) now.reference_capacity = 100 + random.below(200);
    if (kind == 1) now.leaf_capacity = 10;
    if (kind == 2) now.window_end = now.pairs1 + 64 * random.below(500);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    if (kind == 3) store.write(model::Address(order.scene + 4 * random.below(2700)), &nan, 4);
    ft_accel_start(&device, &now);
    EXPECT_TRUE(ft_accel_busy(&device));
    if (kind == 4) {
      const std::uint32_t wait = random.below(20000);
      for (std::uint32_t c = 0; c < wait && ft_accel_busy(&device); c += 4) board.step();
      ft_accel_cancel(&device);
    }
    if (!spoilt) {
      for (std::uint32_t c = random.below(3000); c > 0; --c) board.step();
      for (std::uint32_t word = 0; word < sizeof(ft_accel_order) / 4; ++word) {
        device.write(device.context, FT_ACCEL_ORDER + 4 * word, 64 * random.below(1u << 20));
      }
      EXPECT_TRUE(ft_accel_busy(&device)) << "ordered too late to matter";
    }
    std::uint32_t cycles = 0;
    while (ft_accel_busy(&device))
      ASSERT_LT(++cycles, 100000u)
          << "hangs, status " << device.read(device.context, FT_ACCEL_STATUS) << " kind " << kind;
    const std::uint32_t error = ft_accel_error(&device);
    constexpr std::uint32_t kErrors[] = {FT_ACCEL_REFERENCES, FT_ACCEL_LEAVES, FT_ACCEL_WINDOW,
                                         FT_ACCEL_NOT_FINITE};
    if (kind < 4) {
      EXPECT_EQ(error, kErrors[kind]);
    }
    if (kind == 3) model::write_scene(mesh.view(), map, store);
    if (spoilt) continue;
    ASSERT_EQ(error, 0u);
    ft_accel_result result;
    ft_accel_read_result(&device, &result);
    std::vector<std::uint32_t> words(result.references + 2 * result.leaves +
                                     4 * (result.leaves - 1));
    store.read(model::Address(order.sorted_ids), words.data(), 4 * result.references);
    store.read(model::Address(order.leaf_rows), words.data() + result.references,
               8 * result.leaves);
    store.read(model::Address(order.nodes), words.data() + result.references + 2 * result.leaves,
               16 * (result.leaves - 1));
    words.push_back(result.root);
    if (expected.empty()) {
      expected = words;
      PipeMemory other({});
      const model::SimulationResult alone =
          simulate_rtl(mesh.view(), config, {}, {}, other).value();
      const DeviceImage image = device_image_from_tree(alone.tree).value();
      EXPECT_EQ(std::vector<std::uint32_t>(words.begin(), words.begin() + result.references),
                image.ids);
      EXPECT_EQ(result.root, image.root);
    }
    ASSERT_EQ(words, expected);
  }
  EXPECT_EQ(top->failed_assertions(), 0);
}

}  // namespace
}  // namespace fasttree::rtl
