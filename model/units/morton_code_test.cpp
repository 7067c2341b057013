// SPDX-License-Identifier: Apache-2.0
#include "model/units/morton_code.h"

#include <gtest/gtest.h>

#include "model/units/pair_writer.h"
#include "model/units/unit_bench.h"
#include "reference/morton_code.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

const Grid& unit_grid() {
  static const Grid grid(Box3{{0, 0, 0}, {1, 1, 1}}, AxisSchedule::cyclic, 12);
  return grid;
}

TriangleJob job_of(std::uint32_t id, const std::array<Vec3, 3>& corners) {
  TriangleJob job;
  job.id = id;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t a = 0; a < 3; ++a) job.coordinates[3 * c + a] = corners[c][a];
  }
  return job;
}

TEST(MortonCodeUnit, TakesItsTimeForBoxBoundsAndCells) {
  for (const std::uint32_t quantisers : {1u, 2u, 6u}) {
    PaperConfig::MortonCode config;
    config.quantisers = quantisers;
    MortonCodeUnit unit("mcgu", config);
    unit.set_grid(unit_grid());
    // Two cells in x, three in y, one in z.
    const std::array<Vec3, 3> corners{Vec3{0.05f, 0.05f, 0.05f}, Vec3{0.1f, 0.15f, 0.05f},
                                      Vec3{0.05f, 0.05f, 0.05f}};
    ASSERT_EQ(unit_grid().cells_of(corners).count(), 6u);
    unit.input.push(job_of(9, corners));
    unit.clock();
    std::uint32_t cycles = 0;
    std::vector<Pair> pairs;
    while (!unit.done()) {
      unit.tick();
      if (unit.output.valid()) pairs.push_back(unit.output.pop());
      unit.clock();
      ++cycles;
    }
    ASSERT_EQ(pairs.size(), 6u);
    EXPECT_EQ(pairs.front().code, unit_grid().morton_code({0, 0, 0}));
    EXPECT_EQ(pairs[1].code, unit_grid().morton_code({1, 0, 0})) << "x fastest";
    EXPECT_TRUE(pairs.back().last);
    EXPECT_EQ(pairs.back().id, 9u);
    // Box, the bounds one after the other, the quantiser's latency, the cells, and the queue.
    EXPECT_EQ(cycles, 1 + 6 / quantisers + (config.quantiser_latency - 1) + 6 + 1);
  }
}

TEST(MortonCodeUnit, BeginsTheNextBoxWithTheLastCell) {
  const PaperConfig::MortonCode config;
  MortonCodeUnit unit("mcgu", config);
  unit.set_grid(unit_grid());
  const std::array<Vec3, 3> point{Vec3{0, 0, 0}, Vec3{0, 0, 0}, Vec3{0, 0, 0}};
  std::uint32_t cycles = 0;
  std::vector<std::uint32_t> at;
  for (std::uint32_t id = 0; at.size() < 10; ++cycles) {
    if (unit.input.ready()) unit.input.push(job_of(id++, point));
    unit.tick();
    if (unit.output.valid()) {
      unit.output.drop();
      at.push_back(cycles);
    }
    unit.clock();
  }
  for (std::size_t i = 1; i < at.size(); ++i) {
    EXPECT_EQ(at[i] - at[i - 1], 6 + (config.quantiser_latency - 1) + 1);
  }
}

TEST(MortonCodeUnit, TakesNoTriangleWhileItIterates) {
  PaperConfig::MortonCode config;
  config.output_queue = 1;
  MortonCodeUnit unit("mcgu", config);
  unit.set_grid(unit_grid());
  unit.input.push(job_of(0, {Vec3{0, 0, 0}, Vec3{1, 1, 1}, Vec3{0, 1, 0}}));
  unit.input.push(job_of(1, {Vec3{0, 0, 0}, Vec3{0, 0, 0}, Vec3{0, 0, 0}}));
  for (int cycle = 0; cycle < 100; ++cycle) {
    unit.tick();
    unit.clock();
  }
  EXPECT_EQ(unit.input.visible(), 1u) << "nobody takes the pairs of the first";
  EXPECT_GT(unit.activity().back().stalled(), 50u);
  EXPECT_NE(unit.waits_for().find("triangle 0"), std::string::npos);
}

/// Reader, units and writer: the pairs lie in the reference's order, and their digits are counted.
TEST(MortonCodeUnit, SeveralOfThemWritePairsInOrderOfTheTriangles) {
  const fasttree::test::OwnedMesh mesh = fasttree::test::soup(300, 5, 0.2f);
  const Box3 bounds{{0, 0, 0}, {1, 1, 1}};
  const Grid grid(bounds, AxisSchedule::longest, 9);
  for (const std::uint32_t count : {1u, 3u, 4u}) {
    for (const std::uint32_t key_bytes : {2u, 3u, 4u}) {
      PaperConfig config;
      config.morton_code.units = count;
      config.morton_code.output_queue = 2;
      config.radix_sort.key_bytes = key_bytes;
      test::UnitBench bench(config);
      bench.store.write(Address(0), mesh.positions.data(), mesh.positions.size() * sizeof(Vec3));
      SceneReader reader(config, bench.bus.add_port("scene"));
      PairWriter writer(config, bench.bus.add_port("pairs"));
      std::vector<std::unique_ptr<MortonCodeUnit>> units;
      std::vector<Queue<TriangleJob>*> inputs;
      std::vector<Queue<Pair>*> outputs;
      std::vector<Unit*> all{&reader, &writer};
      Clocks clocks;
      for (std::uint32_t i = 0; i < count; ++i) {
        units.push_back(std::make_unique<MortonCodeUnit>("mcgu", config.morton_code));
        units.back()->set_grid(grid);
        inputs.push_back(&units.back()->input);
        outputs.push_back(&units.back()->output);
        all.push_back(units.back().get());
        clocks.add(*units.back());
      }
      const Address pairs(1 << 16);
      reader.start_triangles(Address(0), 300, inputs);
      writer.start(pairs, 300, outputs);
      bench.run(all, clocks);
      const reference::References expected = reference::morton_code(mesh.view(), grid, 0);
      ASSERT_EQ(writer.written(), expected.size());
      std::vector<std::uint32_t> counts(16);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        const std::uint32_t size = pair_bytes(config);
        std::uint32_t code = 0;
        std::uint32_t id = 0;
        unpack_pair(config, bench.store.view(Address(pairs.value + i * size), size).data(), code,
                    id);
        ASSERT_EQ(code, expected.codes[i]) << i;
        ASSERT_EQ(id, expected.ids[i]) << i;
        ++counts[code & 15];
      }
      EXPECT_EQ(writer.digit_counts(), counts);
    }
  }
}

}  // namespace
}  // namespace fasttree::model
