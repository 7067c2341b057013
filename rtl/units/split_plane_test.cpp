// SPDX-License-Identifier: Apache-2.0
// Planes to the bit against their definition, and the unit's records against the reference.
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <set>

#include "Vplane.h"
#include "Vsplit_plane.h"
#include "fasttree/device_image.h"
#include "model/config/paper_config.h"
#include "reference/internal_node.h"
#include "rtl/bench/bench.h"
#include "rtl/bench/grid_port.h"
#include "rtl/bench/write_memory.h"

namespace fasttree::rtl {
namespace {

/// Bounds of an axis, of all kinds that make arithmetic with floats hard.
class AxisBounds {
 public:
  explicit AxisBounds(std::uint32_t seed) : random_(seed) {}

  void next(float& lo, float& hi) {
    do {
      draw(lo, hi);
    } while (!(hi > lo) || !std::isfinite(hi - lo) || !std::isfinite(finest_scale(hi - lo)));
  }

 private:
  float any(int least, int most) {
    const int exponent = least + static_cast<int>(random_() % std::uint32_t(most - least + 1));
    const auto mantissa = static_cast<float>(random_() % (1u << 23));
    const float size = std::ldexp(1.0f + mantissa * 0x1p-23f, exponent);
    return random_() & 1 ? size : -size;
  }
  float size(int least, int most) { return std::fabs(any(least, most)); }

  void draw(float& lo, float& hi) {
    switch (random_() % 10) {
      case 0:
        lo = any(-10, 10), hi = lo + size(-10, 10);
        break;
      case 1:  // about zero
        hi = size(-113, 126), lo = -hi;
        break;
      case 2:
        lo = random_() & 1 ? 0.0f : -0.0f, hi = size(-114, 127);
        break;
      case 3: {  // floats are coarser than cells
        lo = any(-20, 20);
        const std::uint32_t more = 1 + random_() % 200000;
        hi = std::bit_cast<float>(std::bit_cast<std::uint32_t>(lo) + (lo > 0 ? more : 0u - more));
        break;
      }
      case 4:
        lo = any(-126, 126), hi = lo + size(-126, 126);
        break;
      case 5:  // cells as large as powers of two
        lo = -std::ldexp(static_cast<float>(random_() % 1000), static_cast<int>(random_() % 10));
        hi = lo + std::ldexp(1.0f, static_cast<int>(random_() % 20));
        break;
      case 6:  // a lower bound that is subnormal
        lo = std::bit_cast<float>(static_cast<std::uint32_t>(random_() & 0x807fffffu));
        hi = size(-114, -100);
        break;
      case 7:  // as small as live axes can be
        lo = any(-112, -90), hi = lo + size(-114, -95);
        break;
      case 8:
        lo = -size(-30, 3), hi = 0;
        break;
      default:
        lo = -size(-30, 3), hi = size(-3, 3);
        break;
    }
  }
  std::mt19937 random_;
};

TEST(RtlPlane, IsTheDefinitionsToTheBit) {
  Bench<Vplane> bench(5);
  AxisBounds bounds(6);
  std::uint64_t planes = 0;
  for (int grids = 0; grids < 5000; ++grids) {
    AxisQuantiser quantisers[3];
    float hi[3];
    std::uint32_t bits[3];
    for (std::size_t a = 0; a < 3; ++a) {
      float lo = 0;
      bounds.next(lo, hi[a]);
      quantisers[a] = {lo, finest_scale(hi[a] - lo)};
      bits[a] = 1 + bench.random() % 15;
      set_axis(bench.unit.grid, a, quantisers[a], hi[a] - lo, bits[a]);
    }
    struct Expected {
      std::uint32_t plane, axis, k;
    };
    std::deque<Expected> expected;
    const unsigned in = grids % 4 == 0 ? 50 : 100, out = grids % 4 == 1 ? 50 : 100;
    for (int asked = 0; asked < 250 || !expected.empty();) {
      const std::uint32_t axis = bench.random() % 3;
      const std::uint32_t cells = 1u << bits[axis];
      std::uint32_t k = 1 + bench.random() % (cells - 1);
      if (bench.chance(20)) k = 1u << bench.random() % bits[axis];
      if (bench.chance(5)) k = cells - 1;
      bench.unit.in_valid = asked < 250 && bench.chance(in);
      bench.unit.in_axis = static_cast<std::uint8_t>(axis);
      bench.unit.in_k = static_cast<std::uint16_t>(k);
      bench.settle();
      bench.unit.advance = !bench.unit.out_valid || bench.chance(out);
      ASSERT_EQ(bench.unit.busy, !expected.empty());
      if (bench.unit.in_valid && bench.unit.advance) {
        const float plane = find_plane(quantisers[axis], hi[axis], k << (15 - bits[axis]));
        expected.push_back({std::bit_cast<std::uint32_t>(plane), axis, k});
        ++asked;
      }
      if (bench.unit.out_valid && bench.unit.advance) {
        ASSERT_FALSE(expected.empty());
        const auto [plane, wanted_axis, cell] = expected.front();
        ASSERT_EQ(bench.unit.out_axis, wanted_axis);
        ASSERT_EQ(bench.unit.out_plane, plane)
            << "axis from " << quantisers[wanted_axis].lo << " to " << hi[wanted_axis] << ", cell "
            << cell << " of 2^" << bits[wanted_axis];
        expected.pop_front();
        ++planes;
      }
      bench.cycle();
    }
  }
  EXPECT_GE(planes, 1200000u);
}

struct Node {
  std::uint32_t code;
  int bit;
};

/// Nodes of random leaves, and their records as the reference has them.
struct Case {
  Case(const Grid& grid_, std::uint32_t leaves, std::uint32_t seed) : grid(grid_) {
    std::mt19937 random(seed);
    std::set<std::uint32_t> codes;
    const std::uint32_t most = 1u << grid.depth();
    while (codes.size() < std::min(leaves, most)) codes.insert(random() % most);
    std::uint32_t below = 0;
    bool first = true;
    for (const std::uint32_t code : codes) {
      if (!first) nodes.push_back({code, reference::highest_different_bit(below, code)});
      below = code;
      first = false;
    }
  }
  std::vector<std::uint32_t> records() const {
    std::vector<std::uint32_t> words;
    for (const Node& node : nodes) {
      const Grid::Split split = grid.split_below(node.code, node.bit);
      words.insert(words.end(), {0, 0, std::bit_cast<std::uint32_t>(split.position), split.axis});
    }
    return words;
  }
  const Grid& grid;
  std::vector<Node> nodes;
};

struct Written {
  std::vector<std::uint32_t> words;
  std::uint64_t cycles = 0, busy = 0, idle = 0, stalled = 0;
};

Written run(Bench<Vsplit_plane>& bench, const Case& c, unsigned in, unsigned out) {
  const std::uint32_t base = 0x1000;
  set_grid(bench.unit.grid, c.grid);
  bench.unit.node_valid = 0;
  bench.unit.count = static_cast<std::uint32_t>(c.nodes.size());
  bench.unit.nodes = base;
  bench.unit.start = 1;
  bench.cycle();
  bench.unit.start = 0;
  bench.settle();
  EXPECT_EQ(bench.unit.done, c.nodes.empty());
  WriteMemory memory(64);
  Written result;
  for (std::size_t i = 0; !bench.unit.done; ++result.cycles) {
    if (result.cycles > 1000000) {
      ADD_FAILURE() << "not done";
      break;
    }
    if (!bench.unit.node_valid) bench.unit.node_valid = i < c.nodes.size() && bench.chance(in);
    if (bench.unit.node_valid) {
      bench.unit.node_code = c.nodes[i].code;
      bench.unit.node_bit = static_cast<std::uint8_t>(c.nodes[i].bit);
    }
    bench.unit.wr_ready = bench.chance(out);
    bench.settle();
    memory.look(bench.unit.wr_valid, bench.unit.wr_ready, bench.unit.wr_addr, bench.unit.wr_bytes,
                bench.unit.wr_data);
    ++(bench.unit.activity == 0   ? result.idle
       : bench.unit.activity == 1 ? result.busy
                                  : result.stalled);
    EXPECT_LE(bench.unit.activity, 2);
    const bool taken = bench.unit.node_valid && bench.unit.node_ready;
    bench.cycle();
    if (taken) {
      ++i;
      bench.unit.node_valid = 0;
    }
    bench.settle();
  }
  EXPECT_EQ(bench.unit.activity, 0);
  result.words = memory.run_from(base);
  return result;
}

TEST(RtlSplitPlane, WritesTheReferencesRecords) {
  Bench<Vsplit_plane> bench(3);
  AxisBounds bounds(4);
  for (int i = 0; i < 400; ++i) {
    Box3 box;
    float lo[3], hi[3];
    bounds.next(lo[0], hi[0]);
    for (std::size_t a = 1; a < 3; ++a) {
      // Mostly near the first axis in size: an axis much shorter than another is dead.
      bounds.next(lo[a], hi[a]);
      if (bench.chance(80)) {
        lo[a] = lo[0] * 0.7f;
        hi[a] =
            lo[a] + (hi[0] - lo[0]) * (0.1f + 0.001f * static_cast<float>(bench.random() % 900));
      }
    }
    box = {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
    const Grid grid(box, bench.chance(50) ? AxisSchedule::cyclic : AxisSchedule::longest,
                    static_cast<int>(1 + bench.random() % 30));
    const Case c(grid, bench.random() % 200, bench.random());
    const unsigned in = bench.chance(50) ? 100 : 40, out = bench.chance(50) ? 100 : 20;
    ASSERT_EQ(run(bench, c, in, out).words, c.records()) << i;
  }
  EXPECT_EQ(bench.failed_assertions(), 0);
}

TEST(RtlSplitPlane, TakesANodeACycleAndTheModelsLatency) {
  Bench<Vsplit_plane> bench;
  const model::PaperConfig config;
  const Grid grid({{0, 0, 0}, {1, 1, 1}}, AxisSchedule::cyclic, 20);
  // Of 64 bytes four nodes are a request; the last one is in the writer a cycle later.
  const Case c(grid, 4001, 1);
  const Written at_once = run(bench, c, 100, 100);
  EXPECT_EQ(at_once.cycles, c.nodes.size() * config.internal_node.plane_cycles +
                                config.internal_node.plane_latency);
  EXPECT_EQ(at_once.busy, at_once.cycles);
  const Written slow = run(bench, c, 100, 5);
  EXPECT_GT(slow.stalled, slow.busy);
  const Written starved = run(bench, c, 3, 100);
  EXPECT_GT(starved.idle, starved.busy / 4);
  EXPECT_EQ(starved.stalled, 0u);
}

TEST(RtlSplitPlane, NoticesNodesThatWereNotAnnounced) {
  Bench<Vsplit_plane> bench;
  const Grid grid({{0, 0, 0}, {1, 1, 1}}, AxisSchedule::cyclic, 20);
  const Case c(grid, 2, 1);
  run(bench, c, 100, 100);
  EXPECT_EQ(bench.failed_assertions(), 0);
  bench.unit.node_valid = 1;
  for (int i = 0; i < 30; ++i) bench.cycle();
  EXPECT_GT(bench.failed_assertions(), 0);
}

}  // namespace
}  // namespace fasttree::rtl
