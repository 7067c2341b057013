// SPDX-License-Identifier: Apache-2.0
// The driver's example, in C, on the verilated accelerator: the tree that it leaves in memory is
// the library's.
#include "rtl/driver/example.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <memory>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/device_image.h"
#include "grid/grid.h"
#include "model/system/host_interface.h"
#include "model/system/pipe_memory.h"
#include "rtl/engine/board.h"
#include "rtl/engine/variants.h"
#include "tests/support/meshes.h"

namespace fasttree::rtl {
namespace {

/// The accelerator with its memory, and the processor's copies to and from there.
struct Machine {
  static constexpr std::uint32_t kBytes = 4u << 20;

  Machine() : store(kBytes), axi(memory, store, {}), top(variants().front().make()) {
    board = std::make_unique<Board>(*top, axi, model::MachineConfig{}, 0, nullptr);
  }

  ft_board driver() {
    return {board->driver(),
            4096,
            kBytes - 4096,
            this,
            [](void* m, std::uint32_t address, const void* from, std::size_t bytes) {
              static_cast<Machine*>(m)->store.write(model::Address(address), from, bytes);
            },
            [](void* m, std::uint32_t address, void* to, std::size_t bytes) {
              static_cast<Machine*>(m)->store.read(model::Address(address), to, bytes);
            },
            [](void* m) {
              Board& now = *static_cast<Machine*>(m)->board;
              for (int i = 0; i < 1000000 && !now.irq(); ++i) now.step();
            }};
  }

  model::test::PipeMemory memory{model::test::PipeSettings{}};
  model::ByteStore store;
  AxiMemory axi;
  std::unique_ptr<Top> top;
  std::unique_ptr<Board> board;
};

/// The tree where the order says that it lies.
Tree tree_of(const ft_board& board, const ft_accel_order& order, const ft_accel_result& result) {
  Box3 bounds;
  for (std::size_t a = 0; a < 3; ++a) {
    bounds.lo[a] = std::bit_cast<float>(result.lower[a]);
    bounds.hi[a] = std::bit_cast<float>(result.upper[a]);
  }
  DeviceImage image;
  image.info = Grid(bounds, AxisSchedule::cyclic, static_cast<int>(order.shape & 31u))
                   .tree_info(order.triangles);
  image.root = result.root;
  image.leaves.resize(result.leaves);
  image.internal.resize(result.leaves - 1);
  image.ids.resize(result.references);
  board.from_memory(board.context, order.leaf_rows, image.leaves.data(), 8 * image.leaves.size());
  board.from_memory(board.context, order.nodes, image.internal.data(), 16 * image.internal.size());
  board.from_memory(board.context, order.sorted_ids, image.ids.data(), 4 * image.ids.size());
  return tree_from_device_image(image).value();
}

TEST(RtlDriverExample, LeavesTheLibrarysTree) {
  Machine machine;
  const ft_board board = machine.driver();
  // Large triangles: at the depths first tried there are more than six references each.
  for (const float size : {0.02f, 0.3f}) {
    const fasttree::test::OwnedMesh mesh = fasttree::test::soup(200, 9, size);
    ft_accel_order order;
    ft_accel_result result;
    ASSERT_EQ(ft_board_build(&board, &mesh.positions[0].x, 200, 12, &order, &result), 0);
    EXPECT_LE(result.references, 1200u);
    BuildSettings settings;
    settings.profile = Profile::paper;
    settings.depth = static_cast<int>(order.shape & 31u);
    EXPECT_EQ(settings.depth == 12, size < 0.1f) << settings.depth;
    EXPECT_EQ(tree_of(board, order, result).hash(),
              Builder().build(mesh.view(), settings).value().hash());
  }
}

TEST(RtlDriverExample, HandsOnWhatTheAcceleratorRefuses) {
  Machine machine;
  const ft_board board = machine.driver();
  fasttree::test::OwnedMesh mesh = fasttree::test::soup(50, 9, 0.1f);
  mesh.positions[61][1] = std::numeric_limits<float>::infinity();
  ft_accel_order order;
  ft_accel_result result;
  EXPECT_EQ(ft_board_build(&board, &mesh.positions[0].x, 50, 6, &order, &result),
            FT_ACCEL_NOT_FINITE);
  EXPECT_EQ(result.error_detail, 3u * 61 + 1);
}

}  // namespace
}  // namespace fasttree::rtl
