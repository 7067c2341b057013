// SPDX-License-Identifier: Apache-2.0
// The grid's registers against src/grid, bit for bit, for bounds of every kind.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "Vgrid_setup.h"
#include "grid/axis_schedule.h"
#include "grid/grid.h"
#include "grid/quantiser.h"
#include "model/config/paper_config.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {
namespace {

// Bits of ft_pkg::grid_t, whose last field comes first.
constexpr std::uint32_t kDepth = 0, kRank = kDepth + 5, kMask = kRank + 120, kBits = kMask + 90,
                        kExtent = kBits + 12, kScale = kExtent + 96, kLo = kScale + 96;

/// What a run needs: see docs/accelerator/scene_bound.md.
constexpr std::uint64_t kLeastCycles = 96, kMostCycles = 123;

class GridSetup {
 public:
  /// Runs it, and compares everything. `asked` may be more than 30.
  void check(const Box3& bounds, AxisSchedule schedule, std::uint32_t asked) {
    auto& unit = bench.unit;
    for (std::size_t a = 0; a < 3; ++a) {
      set_word(unit.lo, a, std::bit_cast<std::uint32_t>(bounds.lo[a]));
      set_word(unit.hi, a, std::bit_cast<std::uint32_t>(bounds.hi[a]));
    }
    unit.longest = schedule == AxisSchedule::longest;
    unit.depth_asked = static_cast<std::uint8_t>(asked);
    unit.start = 1;
    bench.cycle();
    unit.start = 0;
    cycles = 1;
    for (; !unit.done; ++cycles) {
      ASSERT_LT(cycles, 1000u);
      bench.cycle();
    }
    most = std::max(most, cycles);
    least = std::min(least, cycles);

    const AxisLevels levels = make_axis_levels(bounds, schedule);
    const int depth = std::min(static_cast<int>(asked), levels.levels);
    const auto bits = levels.bits(depth);
    ASSERT_EQ(field(kDepth, 5), static_cast<std::uint32_t>(depth));
    std::array<std::uint32_t, 3> mask{}, seen{};
    std::array<std::uint32_t, kMaxDepth> rank{};
    for (int i = 0; i < depth; ++i) {
      const std::size_t a = levels.axis[static_cast<std::size_t>(depth - 1 - i)];
      mask[a] |= 1u << i;
      rank[static_cast<std::size_t>(i)] = seen[a]++;
    }
    for (std::uint32_t a = 0; a < 3; ++a) {
      ASSERT_EQ(field(kBits + 4 * a, 4), bits[a]);
      ASSERT_EQ(field(kMask + 30 * a, 30), mask[a]);
      const AxisQuantiser quantiser = make_axis_quantiser(bounds, levels, a);
      const float extent = bounds.hi[a] - bounds.lo[a];
      ASSERT_EQ(field(kLo + 32 * a, 32), std::bit_cast<std::uint32_t>(bounds.lo[a]));
      ASSERT_EQ(field(kScale + 32 * a, 32), std::bit_cast<std::uint32_t>(quantiser.scale));
      ASSERT_EQ(field(kExtent + 32 * a, 32), std::bit_cast<std::uint32_t>(extent))
          << bounds.hi[a] << " less " << bounds.lo[a];
    }
    for (std::uint32_t i = 0; i < kMaxDepth; ++i) ASSERT_EQ(field(kRank + 4 * i, 4), rank[i]);
    live_axes[static_cast<std::size_t>(levels.live[0] + levels.live[1] + levels.live[2])]++;
  }

  std::uint32_t field(std::uint32_t at, std::uint32_t width) const {
    const auto& grid = bench.unit.grid;
    std::uint64_t two = grid[at / 32];
    if (at % 32 + width > 32) two |= std::uint64_t{grid[at / 32 + 1]} << 32;
    return static_cast<std::uint32_t>(two >> (at % 32) & ((std::uint64_t{1} << width) - 1));
  }

  Bench<Vgrid_setup> bench;
  std::uint64_t cycles = 0, most = 0, least = 1000;
  std::array<int, 4> live_axes{};
};

float make(bool minus, std::uint32_t exponent, std::uint32_t fraction) {
  return std::bit_cast<float>(std::uint32_t{minus} << 31 | exponent << 23 | (fraction & 0x7fffff));
}

/// A pair of bounds of a kind: any two; near one another; subnormal; a power of two; a ratio near
/// 2^-20 of `around`; near 2^-113; nothing; huge.
void axis_of(Bench<Vgrid_setup>& bench, std::uint32_t around, float& lo, float& hi) {
  const std::uint32_t r = bench.random();
  const bool minus = bench.chance(50);
  // Fractions with long runs of ones or zeros are those that round in strange ways.
  const auto fraction = [&] {
    const std::uint32_t f = bench.random();
    return bench.chance(50) ? f : bench.chance(50) ? f & 3 : f | 0x7ffffc;
  };
  lo = 0;
  switch (bench.random() % 10) {
    case 0:
      lo = make(minus, r % 255, fraction());
      hi = make(bench.chance(50), (r >> 8) % 255, fraction());
      break;
    case 1:
      lo = make(minus, 1 + r % 254, fraction());
      hi = std::bit_cast<float>(std::bit_cast<std::uint32_t>(lo) + (r >> 8) % 64);
      if (!std::isfinite(hi)) hi = lo;
      break;
    case 2:
      lo = make(minus, r % 3, fraction());
      hi = make(bench.chance(50), (r >> 8) % 3, fraction());
      break;
    case 3:
      hi = make(false, 1 + r % 254, 0);
      break;
    case 4: {
      const std::uint32_t exponent = around > 22 ? around - 22 + r % 4 : r % 4;
      hi = make(false, exponent, fraction());
      break;
    }
    case 5:
      hi = make(false, 12 + r % 4, fraction());
      break;
    case 6:
      lo = hi = make(minus, r % 255, fraction());
      break;
    case 7:
      lo = make(true, 250 + r % 5, fraction());
      hi = make(false, 250 + (r >> 8) % 5, fraction());
      break;
    default: {
      // Like a scene's, of alike exponents.
      const std::uint32_t exponent = around + r % 8;
      lo = make(minus, std::min(exponent, 254u), fraction());
      hi = make(bench.chance(50), std::min(around + (r >> 8) % 32, 254u), fraction());
    }
  }
  if (lo > hi) std::swap(lo, hi);
  lo += 0.0f;
  hi += 0.0f;
}

TEST(RtlGridSetup, IsTheGridToTheBit) {
  GridSetup setup;
  auto& bench = setup.bench;
  for (int i = 0; i < 250000; ++i) {
    const std::uint32_t around = bench.random() % 255;
    std::array<float, 3> lo{}, hi{};
    for (std::size_t a = 0; a < 3; ++a) axis_of(bench, around, lo[a], hi[a]);
    // Equal extents in part of the cases, whose order the tie decides.
    if (bench.chance(10)) lo[1] = lo[0], hi[1] = hi[0];
    if (bench.chance(10)) lo[2] = lo[1], hi[2] = hi[1];
    const auto schedule = bench.chance(50) ? AxisSchedule::cyclic : AxisSchedule::longest;
    setup.check({{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}}, schedule, bench.random() % 32);
    ASSERT_FALSE(HasFatalFailure()) << "case " << i;
  }
  for (const int count : setup.live_axes) EXPECT_GT(count, 5000);
  EXPECT_EQ(setup.most, kMostCycles);
  EXPECT_EQ(setup.least, kLeastCycles);
  EXPECT_EQ(bench.failed_assertions(), 0);
}

TEST(RtlGridSetup, HasTheEdgesOfItsRules) {
  GridSetup setup;
  const float least = 0x1p-113f, above = 0x1.000002p-113f;
  const float edges[] = {0.0f,
                         0x1p-149f,
                         0x1p-126f,
                         0x1.fffffcp-127f,
                         least,
                         above,
                         0x1p-112f,
                         0x1p-93f,
                         0x1.000002p-93f,
                         0x1p-20f,
                         0x1.8p-1f,
                         1.0f,
                         3.0f,
                         0x1.fffffep0f,
                         0x1.000002p-20f,
                         0x1p127f,
                         0x1p107f,
                         0x1.000002p107f,
                         std::numeric_limits<float>::max()};
  for (const float x : edges) {
    for (const float y : edges) {
      for (const float z : edges) {
        for (const auto schedule : {AxisSchedule::cyclic, AxisSchedule::longest}) {
          setup.check({{0, 0, 0}, {x, y, z}}, schedule, 30);
          ASSERT_FALSE(HasFatalFailure()) << x << ' ' << y << ' ' << z;
        }
      }
    }
  }
  // An extent that overflows leaves no axis alive.
  const float huge = std::numeric_limits<float>::max();
  setup.check({{-huge, 0, 0}, {huge, 1, huge}}, AxisSchedule::longest, 12);
  EXPECT_EQ(setup.bench.failed_assertions(), 0);
}

// The masks and the ranks take a code apart as Grid does.
TEST(RtlGridSetup, TakesCodesApartLikeTheGrid) {
  GridSetup setup;
  for (int i = 0; i < 300; ++i) {
    const Box3 bounds{{-1, -2, 0}, {1.5f, 2, 0.001f * static_cast<float>(1 + i % 7)}};
    const auto schedule = i % 2 ? AxisSchedule::cyclic : AxisSchedule::longest;
    const Grid grid(bounds, schedule, i % 31);
    setup.check(bounds, schedule, static_cast<std::uint32_t>(i % 31));
    for (int n = 0; n < 100; ++n) {
      const std::uint32_t code = setup.bench.random() & ((1u << grid.depth()) - 1);
      for (std::uint32_t a = 0; a < 3; ++a) {
        std::uint32_t coordinate = 0;
        for (std::uint32_t b = 0; b < kMaxDepth; ++b) {
          if (!(code >> b & setup.field(kMask + 30 * a, 30) >> b & 1)) continue;
          coordinate |= 1u << setup.field(kRank + 4 * b, 4);
        }
        ASSERT_EQ(coordinate, grid.coordinate_of(code, a));
      }
    }
  }
}

TEST(RtlGridSetup, TakesTheCyclesOfTheModel) {
  GridSetup setup;
  // Like most scenes, round the origin: each subtraction shifts a place or two.
  setup.check({{-0.095f, 0.033f, -0.062f}, {0.061f, 0.187f, 0.059f}}, AxisSchedule::cyclic, 18);
  const std::uint64_t model = model::PaperConfig().control.setup_cycles;
  EXPECT_EQ(setup.cycles, model);
}

TEST(RtlGridSetup, SaysWhatMayNotCome) {
  GridSetup setup;
  auto& unit = setup.bench.unit;
  for (std::size_t a = 0; a < 3; ++a) {
    set_word(unit.lo, a, std::bit_cast<std::uint32_t>(2.0f));
    set_word(unit.hi, a, std::bit_cast<std::uint32_t>(a == 0 ? 1.0f : 2.0f));
  }
  unit.start = 1;
  setup.bench.cycle();
  unit.start = 0;
  setup.bench.cycle();
  EXPECT_EQ(setup.bench.failed_assertions(), 1) << "a lower bound above the upper one";
  unit.start = 1;
  setup.bench.cycle();
  EXPECT_EQ(setup.bench.failed_assertions(), 2) << "started while at work";
}

}  // namespace
}  // namespace fasttree::rtl
