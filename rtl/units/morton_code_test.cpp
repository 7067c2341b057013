// SPDX-License-Identifier: Apache-2.0
// MCGU and pair writer against the library's grid and the model.
#include "model/units/morton_code.h"

#include <gtest/gtest.h>

#include <bit>
#include <deque>
#include <map>
#include <vector>

#include "Vmorton_code.h"
#include "Vpair_writer.h"
#include "grid/grid.h"
#include "rtl/bench/bench.h"
#include "rtl/bench/grid_port.h"
#include "rtl/bench/write_memory.h"
#include "tests/support/meshes.h"

namespace fasttree::rtl {
namespace {

struct Made {
  std::uint32_t code, id;
  bool last;
  friend bool operator==(const Made&, const Made&) = default;
};

// x fastest, then y, then z.
void cells_of(const Grid& grid, const std::array<Vec3, 3>& triangle, std::uint32_t id,
              std::vector<Made>& made) {
  const CellBox box = grid.cells_of(triangle);
  for (std::uint32_t z = box.lo[2]; z <= box.hi[2]; ++z) {
    for (std::uint32_t y = box.lo[1]; y <= box.hi[1]; ++y) {
      for (std::uint32_t x = box.lo[0]; x <= box.hi[0]; ++x) {
        made.push_back({grid.morton_code({x, y, z}), id, Cell{x, y, z} == box.hi});
      }
    }
  }
}

struct Scene {
  Grid grid;
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<Made> pairs;
};

Scene random_scene(fasttree::test::Random& random, std::uint32_t triangles) {
  Scene scene;
  Box3 box{random.point(-3, 0), random.point(0.5f, 4)};
  if (random.below(5) == 0) box.hi.y = box.lo.y;
  scene.grid = Grid(box, random.below(2) ? AxisSchedule::cyclic : AxisSchedule::longest,
                    static_cast<int>(random.below(31)));
  // About so large as the cells.
  const float size = 6.0f / static_cast<float>(1u << (scene.grid.depth() / 3));
  for (std::uint32_t t = 0; t < triangles; ++t) {
    std::array<Vec3, 3> corners;
    const Vec3 at = random.point(-3, 4);
    for (Vec3& corner : corners) corner = at + random.point(-size, size) * 0.5f;
    scene.triangles.push_back(corners);
    cells_of(scene.grid, corners, t + 100, scene.pairs);
  }
  return scene;
}

std::uint32_t pair_word(const Vmorton_code& unit, bool second, std::size_t i) {
  return second ? get_word(unit.pair1, i) : get_word(unit.pair0, i);
}

/// The pairs in the order in which they come, and the cycles to the last one.
std::vector<Made> run(const Scene& scene, std::uint32_t seed, unsigned in_percent,
                      unsigned out_percent, std::uint64_t& cycles) {
  Bench<Vmorton_code> bench(seed);
  Vmorton_code& unit = bench.unit;
  set_grid(unit.grid, scene.grid);
  unit.tri_valid = 0;
  unit.pair_take = 0;
  bench.settle();
  std::vector<Made> made;
  std::size_t next = 0;
  const std::uint64_t begin = bench.cycles();
  bool waits = false;
  while (made.size() < scene.pairs.size() && bench.cycles() - begin < 10000000) {
    if (next < scene.triangles.size() && (waits || bench.chance(in_percent))) {
      unit.tri_valid = 1;
      unit.tri_id = static_cast<std::uint32_t>(next + 100);
      for (std::size_t c = 0; c < 9; ++c) {
        set_word(unit.tri_coords, c,
                 std::bit_cast<std::uint32_t>(scene.triangles[next][c / 3][c % 3]));
      }
    } else {
      unit.tri_valid = 0;
    }
    bench.settle();
    unit.pair_take = 0;
    if (bench.chance(out_percent)) {
      unit.pair_take = static_cast<std::uint8_t>(
          out_percent == 100 ? unit.pair_count
                             : std::min<unsigned>(unit.pair_count, bench.random() % 3));
    }
    for (unsigned p = 0; p < unit.pair_take; ++p) {
      made.push_back({pair_word(unit, p == 1, 0), pair_word(unit, p == 1, 1),
                      (pair_word(unit, p == 1, 2) & 1) != 0});
    }
    bench.settle();
    waits = unit.tri_valid && !unit.tri_ready;
    next += unit.tri_valid && unit.tri_ready;
    bench.cycle();
  }
  cycles = bench.cycles() - begin;
  unit.tri_valid = 0;
  unit.pair_take = 0;
  for (int i = 0; i < 20; ++i) bench.cycle();
  bench.settle();
  EXPECT_TRUE(unit.done);
  EXPECT_EQ(unit.pair_count, 0);
  EXPECT_EQ(bench.failed_assertions(), 0);
  return made;
}

TEST(RtlMortonCode, MakesTheLibrarysCodesOfAMillionCells) {
  fasttree::test::Random random(9);
  std::uint64_t pairs = 0;
  for (std::uint32_t i = 0; pairs < 1000000; ++i) {
    const Scene scene = random_scene(random, 200);
    std::uint64_t cycles = 0;
    const unsigned in = i % 3 == 0 ? 100 : 30, out = i % 2 == 0 ? 100 : 40;
    ASSERT_EQ(run(scene, i + 1, in, out, cycles), scene.pairs) << i;
    pairs += scene.pairs.size();
  }
}

TEST(RtlMortonCode, TakesTheModelsCycles) {
  fasttree::test::Random random(10);
  for (int i = 0; i < 50; ++i) {
    const Scene scene = random_scene(random, 100);
    std::uint64_t cycles = 0;
    run(scene, 3, 100, 100, cycles);
    model::MortonCodeUnit unit("mcgu", {});
    unit.set_grid(scene.grid);
    std::size_t next = 0, made = 0;
    std::uint64_t expected = 0;
    for (; made < scene.pairs.size(); ++expected) {
      if (next < scene.triangles.size() && unit.input.ready()) {
        model::TriangleJob job;
        job.id = static_cast<std::uint32_t>(next + 100);
        for (std::size_t c = 0; c < 9; ++c) {
          job.coordinates[c] = scene.triangles[next][c / 3][c % 3];
        }
        unit.input.push(job);
        ++next;
      }
      for (int p = 0; p < 2 && unit.output.valid(); ++p, ++made) unit.output.drop();
      unit.tick();
      unit.clock();
    }
    EXPECT_NEAR(static_cast<double>(cycles), static_cast<double>(expected), 2) << i;
  }
}

// ---- The pair writer behind four of them.

void set_pair(Vpair_writer& unit, std::size_t u, bool second, const Made& made) {
  for (std::size_t i = 0; i < 65; ++i) {
    const std::uint32_t bit = i < 32   ? made.code >> i & 1
                              : i < 64 ? made.id >> (i - 32) & 1
                                       : made.last;
    set_bits(second ? unit.pair1 : unit.pair0, 65 * u + i, 1, bit);
  }
}

TEST(RtlPairWriter, WritesPairsInTheOrderOfTheTriangles) {
  fasttree::test::Random random(11);
  for (std::uint32_t i = 0; i < 60; ++i) {
    const std::uint32_t triangles = random.below(80);
    std::vector<Made> all;
    std::deque<Made> queues[4];
    std::uint32_t counts[16] = {};
    std::uint32_t shown[4] = {};
    for (std::uint32_t t = 0; t < triangles; ++t) {
      const std::uint32_t cells = 1 + random.below(9);
      for (std::uint32_t c = 0; c < cells; ++c) {
        const Made made{random.below(1u << 30), t, c + 1 == cells};
        all.push_back(made);
        queues[t % 4].push_back(made);
      }
    }
    // Every third time there is not enough room.
    const std::uint32_t capacity = i % 3 == 2 ? static_cast<std::uint32_t>(all.size()) / 2
                                              : static_cast<std::uint32_t>(all.size()) + 3;
    Bench<Vpair_writer> bench(i + 1);
    Vpair_writer& unit = bench.unit;
    WriteMemory memory(32);
    unit.addr = 4096;
    unit.triangles = triangles;
    unit.capacity = capacity;
    unit.pair_count = 0;
    unit.start = 1;
    bench.cycle();
    unit.start = 0;
    bench.settle();
    const std::uint64_t begin = bench.cycles();
    while (!unit.done && bench.cycles() - begin < 100000) {
      std::uint32_t seen = 0;
      for (std::size_t u = 0; u < 4; ++u) {
        // What has been seen stays until it is taken.
        const std::uint32_t most = bench.chance(80) ? 2 : bench.random() % 2;
        const auto count = static_cast<std::uint32_t>(
            std::min<std::size_t>(queues[u].size(), std::max(most, shown[u])));
        shown[u] = count;
        seen |= count << 2 * u;
        for (std::size_t p = 0; p < count; ++p) set_pair(unit, u, p == 1, queues[u][p]);
      }
      unit.pair_count = static_cast<std::uint8_t>(seen);
      unit.wr_ready = bench.chance(i % 2 ? 100 : 50);
      bench.settle();
      memory.look(unit.wr_valid, unit.wr_ready, unit.wr_addr, unit.wr_bytes, unit.wr_data);
      const std::uint32_t take = unit.pair_take;
      bench.cycle();
      for (std::size_t u = 0; u < 4; ++u) {
        for (std::uint32_t p = 0; p < (take >> 2 * u & 3); ++p) {
          ASSERT_LT(p, seen >> 2 * u & 3) << "taken what was not there";
          queues[u].pop_front();
          --shown[u];
        }
      }
      bench.settle();
    }
    ASSERT_TRUE(unit.done) << i;
    const std::size_t written = std::min<std::size_t>(all.size(), capacity);
    EXPECT_EQ(unit.overflow, all.size() > capacity) << i;
    EXPECT_EQ(unit.written, written) << i;
    std::vector<std::uint32_t> words;
    for (std::size_t p = 0; p < written; ++p) {
      words.insert(words.end(), {all[p].code, all[p].id});
      ++counts[all[p].code & 15];
    }
    EXPECT_EQ(memory.run_from(4096), words) << i;
    for (std::size_t d = 0; d < 16; ++d) EXPECT_EQ(get_word(unit.counts, d), counts[d]) << i;
    EXPECT_EQ(bench.failed_assertions(), 0);
  }
}

}  // namespace
}  // namespace fasttree::rtl
