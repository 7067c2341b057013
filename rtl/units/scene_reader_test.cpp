// SPDX-License-Identifier: Apache-2.0
// The scene reader for buses of 8 to 64 bytes: what the units get, coordinates that are not finite,
// and its rate against the model's.
#include "model/units/scene_reader.h"

#include <gtest/gtest.h>

#include <bit>
#include <optional>
#include <set>

#include "Vscene_reader.h"
#include "Vscene_reader_32.h"
#include "Vscene_reader_64.h"
#include "Vscene_reader_8.h"
#include "model/units/scene_bound.h"
#include "model/units/unit_bench.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {
namespace {

constexpr std::uint32_t kNotANumber = 0x7fc00000;
constexpr std::uint32_t kStalledBus = 2, kStalledUnits = 3;

bool is_finite(std::uint32_t word) {
  return (word >> 23 & 255) != 255;
}

struct Rates {
  unsigned beats = 100;  ///< percent of the cycles that have one
  unsigned units = 100;  ///< percent of the cycles in which a unit is ready
};

/// The reader with its stream and with units that take down what they get.
template <typename Model, std::uint32_t BusWords, std::uint32_t Inputs, std::uint32_t Units>
struct Reader {
  static constexpr std::uint32_t kWords = BusWords;
  static constexpr std::uint32_t kInputs = Inputs;

  explicit Reader(std::uint32_t seed) : bench(seed) {}

  std::vector<std::uint32_t> random_scene(std::uint32_t triangles) {
    std::vector<std::uint32_t> words(triangles * 9);
    for (auto& word : words) {
      do word = bench.random();
      while (!is_finite(word));
    }
    return words;
  }

  /// Until done, from the start on; behind the scene's end there is what is no number.
  void run(bool bounds, const std::vector<std::uint32_t>& scene, const Rates& rates) {
    const auto triangles = static_cast<std::uint32_t>(scene.size() / 9);
    auto& unit = bench.unit;
    unit.triangles = triangles;
    unit.rd_valid = 0;
    unit.group_ready = unit.tri_ready = 0;
    unit.start_bounds = bounds;
    unit.start_triangles = !bounds;
    bench.cycle();
    unit.start_bounds = unit.start_triangles = 0;
    for (auto& list : values) list.clear();
    groups = beats = cycles = 0;
    held = {};
    taken.clear();
    for (bool offered = false;; ++cycles) {
      // What waits stays.
      offered = offered || bench.chance(rates.beats);
      const bool more = std::size_t{beats} * BusWords < scene.size();
      unit.rd_valid = offered && more;
      for (std::uint32_t i = 0; i < BusWords; ++i) {
        const std::size_t at = std::size_t{beats} * BusWords + i;
        set_word(unit.rd_data, i, at < scene.size() ? scene[at] : kNotANumber);
      }
      unit.group_ready = bench.chance(rates.units);
      std::uint32_t ready = 0;
      for (std::uint32_t u = 0; u < Units; ++u) ready |= bench.chance(rates.units) ? 1u << u : 0;
      unit.tri_ready = static_cast<std::uint8_t>(ready);
      bench.settle();
      if (unit.done) break;
      ASSERT_LT(cycles, 100 * (scene.size() + 100));
      const bool fired = unit.rd_valid && unit.rd_ready;
      const bool worked =
          fired || (unit.group_valid && unit.group_ready) || (unit.tri_valid & unit.tri_ready) != 0;
      const bool waits = unit.group_valid || unit.tri_valid != 0;
      ASSERT_EQ(unit.activity, worked ? 1u : waits ? kStalledUnits : kStalledBus);
      look_at_group();
      look_at_triangle(triangles);
      if (fired) {
        offered = false;
        ++beats;
      }
      bench.cycle();
    }
    EXPECT_EQ(unit.activity, 0);
    EXPECT_EQ(beats, (scene.size() + BusWords - 1) / BusWords) << "all of the stream is read";
  }

  // Also that what is not taken stays.
  void look_at_group() {
    auto& unit = bench.unit;
    if (!unit.group_valid) {
      ASSERT_FALSE(held) << "a group was taken back";
      return;
    }
    std::vector<std::uint32_t> group{unit.group_axis};
    for (std::size_t i = 0; i < Inputs; ++i) group.push_back(get_word(unit.group_values, i));
    if (held) {
      ASSERT_EQ(*held, group);
    }
    held = group;
    if (!unit.group_ready) return;
    held.reset();
    ++groups;
    ASSERT_LT(group[0], 3u);
    values[group[0]].insert(group.begin() + 1, group.end());
  }
  void look_at_triangle(std::uint32_t triangles) {
    auto& unit = bench.unit;
    const std::uint32_t valid = unit.tri_valid;
    if (valid == 0) return;
    ASSERT_EQ(valid, 1u << taken.size() / 9 % Units) << "the units in turn";
    ASSERT_EQ(unit.tri_id, taken.size() / 9);
    ASSERT_LT(unit.tri_id, triangles);
    if ((valid & unit.tri_ready) == 0) return;
    for (std::size_t i = 0; i < 9; ++i) taken.push_back(get_word(unit.tri_coords, i));
  }

  /// Every coordinate of an axis, and nothing else, has come.
  void expect_all_values(const std::vector<std::uint32_t>& scene) {
    std::array<std::set<std::uint32_t>, 3> expected;
    for (std::size_t i = 0; i < scene.size(); ++i) expected[i % 3].insert(scene[i]);
    EXPECT_EQ(values, expected);
  }

  Bench<Model> bench;
  std::array<std::set<std::uint32_t>, 3> values;  ///< by axis
  std::optional<std::vector<std::uint32_t>> held;
  std::vector<std::uint32_t> taken;  ///< coordinates of triangles
  std::uint32_t groups = 0;
  std::uint32_t beats = 0;
  std::uint64_t cycles = 0;
};

template <typename R>
class RtlSceneReader : public ::testing::Test {};
using Readers =
    ::testing::Types<Reader<Vscene_reader, 4, 8, 4>, Reader<Vscene_reader_8, 2, 8, 3>,
                     Reader<Vscene_reader_32, 8, 8, 4>, Reader<Vscene_reader_64, 16, 16, 1>>;
TYPED_TEST_SUITE(RtlSceneReader, Readers);

constexpr Rates kRates[] = {{100, 100}, {100, 30}, {30, 100}, {60, 60}, {95, 10}};

TYPED_TEST(RtlSceneReader, BringsEveryCoordinateToTheBounds) {
  TypeParam reader(1);
  for (const Rates& rates : kRates) {
    for (std::uint32_t triangles = 0; triangles < 45; ++triangles) {
      const auto scene = reader.random_scene(triangles < 40 ? triangles : triangles * 10);
      reader.run(true, scene, rates);
      reader.expect_all_values(scene);
      EXPECT_EQ(reader.bench.unit.bad, 0);
      if (this->HasFatalFailure() || this->HasNonfatalFailure()) return;
    }
  }
  EXPECT_EQ(reader.bench.failed_assertions(), 0);
}

TYPED_TEST(RtlSceneReader, BringsTrianglesToTheUnitsInTurn) {
  TypeParam reader(2);
  for (const Rates& rates : kRates) {
    for (std::uint32_t triangles = 0; triangles < 45; ++triangles) {
      const auto scene = reader.random_scene(triangles < 40 ? triangles : triangles * 10);
      reader.run(false, scene, rates);
      ASSERT_EQ(reader.taken, scene);
    }
  }
  EXPECT_EQ(reader.bench.failed_assertions(), 0);
}

TYPED_TEST(RtlSceneReader, StopsAtTheFirstCoordinateThatIsNotFinite) {
  TypeParam reader(3);
  auto& unit = reader.bench.unit;
  for (int run = 0; run < 600; ++run) {
    const std::uint32_t triangles = 1 + reader.bench.random() % (run % 2 ? 3 : 40);
    auto scene = reader.random_scene(triangles);
    std::uint32_t first = 9 * triangles;
    for (std::uint32_t i = 0, n = 1 + run % 3; i < n; ++i) {
      const std::uint32_t at = reader.bench.random() % (9 * triangles);
      scene[at] = 0x7f800000 | (reader.bench.random() & 0x80000001);
      first = std::min(first, at);
    }
    const Rates rates = kRates[static_cast<std::size_t>(run) % 5];
    reader.run(true, scene, rates);
    ASSERT_EQ(unit.bad, 1);
    ASSERT_EQ(unit.bad_word, first);
    for (const auto& list : reader.values) {
      for (const std::uint32_t word : list) ASSERT_TRUE(is_finite(word));
    }
    reader.run(false, scene, rates);
    ASSERT_TRUE(reader.taken.empty()) << "reads, and hands nothing on";
    ASSERT_EQ(unit.bad_word, first);
    const auto next = reader.random_scene(triangles);
    reader.run(true, next, rates);
    ASSERT_EQ(unit.bad, 0) << "forgotten with the next start";
    reader.expect_all_values(next);
  }
  EXPECT_EQ(reader.bench.failed_assertions(), 0);
}

/// Takes a triangle in every cycle.
class Taker : public model::Unit {
 public:
  Taker() : Unit("taker", "taker", {}), input(2) {}
  model::Queue<model::TriangleJob> input;
  void tick() override {
    if (input.valid()) input.drop();
    busy();
  }
  bool done() const override { return input.empty(); }
  std::string waits_for() const override { return {}; }
  void clock() { input.clock(); }
};

std::uint64_t model_cycles(bool bounds, std::uint32_t triangles, std::uint32_t bus_words,
                           std::uint32_t inputs) {
  model::PaperConfig config;
  config.bus.bytes = bus_words * 4;
  config.bus.read_ahead_bytes = 4096;  // enough for a wide bus, too
  config.scene_bound.inputs = inputs;
  model::test::UnitBench bench(config);
  model::SceneReader reader(config, bench.bus.add_port("scene"));
  model::SceneBoundUnit lower(model::SceneBoundUnit::Side::lower, config.scene_bound);
  Taker taker;
  model::Clocks clocks;
  clocks.add(lower);
  clocks.add(taker);
  if (bounds) {
    reader.start_bounds(model::Address(0), triangles, {&lower.input});
  } else {
    reader.start_triangles(model::Address(0), triangles, {&taker.input});
  }
  return bench.run({&reader, &lower, &taker}, clocks);
}

// The model's memory has a latency and its queues have one: the same number for every scene.
TYPED_TEST(RtlSceneReader, IsAsFastAsTheModel) {
  constexpr std::uint32_t kSmall = 400, kLarge = 2400;
  TypeParam reader(4);
  for (const bool bounds : {true, false}) {
    std::array<std::int64_t, 2> ours{}, models{};
    for (std::size_t i = 0; i < 2; ++i) {
      const std::uint32_t triangles = i == 0 ? kSmall : kLarge;
      reader.run(bounds, reader.random_scene(triangles), {});
      ours[i] = static_cast<std::int64_t>(reader.cycles);
      models[i] = static_cast<std::int64_t>(
          model_cycles(bounds, triangles, TypeParam::kWords, TypeParam::kInputs));
      EXPECT_LE(ours[i], models[i]);
      EXPECT_GE(ours[i] + 40, models[i]) << "latency of memory, and of the queues";
      // A beat a cycle, or a triangle.
      const std::int64_t least =
          std::max<std::int64_t>(triangles * 9 / TypeParam::kWords, bounds ? 0 : triangles);
      EXPECT_LE(ours[i], least + 6);
    }
    EXPECT_LE(std::abs((ours[1] - ours[0]) - (models[1] - models[0])), 2);
  }
}

TYPED_TEST(RtlSceneReader, SaysWhereItIsStartedAtWork) {
  TypeParam reader(5);
  auto& unit = reader.bench.unit;
  unit.triangles = 5;
  unit.rd_valid = 0;
  unit.group_ready = unit.tri_ready = 0;
  unit.start_triangles = 0;
  unit.start_bounds = 1;
  reader.bench.cycle();
  EXPECT_EQ(reader.bench.failed_assertions(), 0);
  reader.bench.cycle();
  EXPECT_EQ(reader.bench.failed_assertions(), 1);
}

}  // namespace
}  // namespace fasttree::rtl
