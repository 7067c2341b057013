// SPDX-License-Identifier: Apache-2.0
// The quantiser bit for bit against the library's, over every kind of coordinate.
#include "grid/quantiser.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <deque>
#include <limits>
#include <vector>

#include "Vquantiser.h"
#include "grid/grid.h"
#include "rtl/bench/bench.h"
#include "tests/support/meshes.h"

namespace fasttree::rtl {
namespace {

constexpr int kLatency = 6;  // ft_pkg::QuantiserLatency

std::uint32_t bits_of(float v) {
  return std::bit_cast<std::uint32_t>(v);
}

/// Values go in one after the other, with gaps now and then, and cells come out in order.
class Stream {
 public:
  void put(const AxisQuantiser& quantiser, std::uint32_t bits, float value) {
    if (bench_.random() % 64 == 0) cycle(false);
    bench_.unit.in_value = bits_of(value);
    bench_.unit.in_lo = bits_of(quantiser.lo);
    bench_.unit.in_scale = bits_of(quantiser.scale);
    bench_.unit.in_bits = static_cast<std::uint8_t>(bits);
    const std::uint32_t cell = quantiser(value);
    inside_ += cell > 0 && cell < kFinestCells - 1;
    ++values_;
    expected_.push_back({cycles_, cell >> (kMaxAxisBits - bits), (1u << bits) - 1, value});
    cycle(true);
  }
  void drain() {
    for (int i = 0; i < kLatency; ++i) cycle(false);
    EXPECT_TRUE(expected_.empty());
  }
  double share_inside() const {
    return static_cast<double>(inside_) / static_cast<double>(values_);
  }
  int wrong() const { return wrong_; }
  std::uint64_t values() const { return values_; }

 private:
  struct Expected {
    std::uint64_t cycle;
    std::uint32_t cell, last;
    float value;
  };
  void cycle(bool valid) {
    bench_.unit.in_valid = valid;
    bench_.cycle();
    ++cycles_;
    const bool due = !expected_.empty() && expected_.front().cycle + kLatency == cycles_;
    if (due != static_cast<bool>(bench_.unit.out_valid)) ++wrong_;
    if (!due) return;
    const Expected& expected = expected_.front();
    const std::uint32_t cell = bench_.unit.out_below   ? 0
                               : bench_.unit.out_above ? expected.last
                                                       : bench_.unit.out_place;
    if (cell != expected.cell && ++wrong_ < 5) {
      ADD_FAILURE() << expected.value << " is in cell " << expected.cell << ", not " << cell;
    }
    expected_.pop_front();
  }

  Bench<Vquantiser> bench_;
  std::deque<Expected> expected_;
  std::uint64_t cycles_ = 0, values_ = 0, inside_ = 0;
  int wrong_ = 0;
};

Box3 random_bounds(fasttree::test::Random& random) {
  const auto value = [&] {
    const float v = random.in(-1, 1);
    return std::ldexp(v, static_cast<int>(random.below(random.below(4) == 0 ? 240 : 12)) -
                             (random.below(4) == 0 ? 126 : 6));
  };
  Box3 box;
  for (std::size_t a = 0; a < 3; ++a) {
    const float x = value(), y = value();
    box.lo[a] = std::min(x, y);
    box.hi[a] = std::max(x, y);
  }
  if (random.below(8) == 0) box.hi[random.below(3)] = box.lo[random.below(3)];
  for (std::size_t a = 0; a < 3; ++a) {
    if (box.hi[a] < box.lo[a]) std::swap(box.hi[a], box.lo[a]);
  }
  return box;
}

TEST(RtlQuantiser, GivesTheLibrarysCellsOfTenMillionValues) {
  fasttree::test::Random random(5);
  Stream stream;
  while (stream.values() < 10000000) {
    const Grid grid(random_bounds(random), AxisSchedule::longest,
                    static_cast<int>(random.below(31)));
    const std::size_t a = random.below(3);
    const AxisQuantiser& quantiser = grid.quantiser(a);
    if (quantiser.scale == 0 && random.below(8) != 0) continue;
    const std::uint32_t bits = grid.bits()[a];
    const float lo = grid.bounds().lo[a], hi = grid.bounds().hi[a];
    for (int i = 0; i < 20000; ++i) {
      stream.put(quantiser, bits, std::clamp(random.in(lo, hi), lo, hi));
    }
    for (const float v :
         {lo, hi, 0.0f, -0.0f, std::nextafter(lo, -1e38f), std::nextafter(hi, 1e38f),
          std::numeric_limits<float>::denorm_min(), -std::numeric_limits<float>::denorm_min(),
          std::numeric_limits<float>::min(), 1.0f, -1.0f}) {
      stream.put(quantiser, bits, v);
    }
  }
  stream.drain();
  EXPECT_EQ(stream.wrong(), 0);
  EXPECT_GT(stream.share_inside(), 0.6);
}

/// Where cells meet: the planes, and the floats next to them.
TEST(RtlQuantiser, HasTheLibrarysCellEdges) {
  fasttree::test::Random random(6);
  Stream stream;
  for (int run = 0; run < 300; ++run) {
    const Grid grid(random_bounds(random), AxisSchedule::cyclic, 30);
    const std::size_t a = random.below(3);
    if (grid.bits()[a] == 0) continue;
    for (int i = 0; i < 500; ++i) {
      const float plane = grid.plane(a, 1 + random.below((1u << grid.bits()[a]) - 1));
      for (const float v : {std::nextafter(plane, -1e38f), plane, std::nextafter(plane, 1e38f)}) {
        stream.put(grid.quantiser(a), grid.bits()[a], v);
      }
    }
  }
  stream.drain();
  EXPECT_EQ(stream.wrong(), 0);
  EXPECT_GT(stream.values(), 100000u);
}

/// Products half-way between two values, of which the even one is a cell's edge; and differences of
/// subnormal values.
TEST(RtlQuantiser, RoundsTiesToEvenAndTakesSubnormalValues) {
  fasttree::test::Random random(7);
  Stream stream;
  for (std::uint32_t cell = 25168; cell < 32768; cell += 3) {
    // Exact, and three halves of it are a unit in the tenth place below the cell's edge.
    const auto third = static_cast<float>((1024 * cell - 1) / 3);
    stream.put({0.0f, 1.5f}, kMaxAxisBits, std::ldexp(third, -9));
  }
  for (int i = 0; i < 20000; ++i) {
    const float lo = std::ldexp(random.in(-1, 1), -126);
    stream.put({lo, 0x1p127f}, kMaxAxisBits, lo + std::ldexp(random.in(0, 1), -124));
  }
  stream.drain();
  EXPECT_EQ(stream.wrong(), 0);
}

}  // namespace
}  // namespace fasttree::rtl
