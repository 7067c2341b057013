// SPDX-License-Identifier: Apache-2.0
#include "model/units/scene_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/units/unit_bench.h"
#include "reference/scene_bound.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

using Side = SceneBoundUnit::Side;

TEST(SceneBoundUnit, TakesAGroupEveryCycleThroughThreeStages) {
  SceneBoundUnit unit(Side::lower, {});
  CoordinateGroup group;
  group.axis = 1;
  group.values = {5, 4, 3, 2, -1, 7, 8, 9};
  unit.input.push(group);
  unit.clock();
  int cycles = 0;
  while (!unit.done()) {
    unit.tick();
    unit.clock();
    ++cycles;
  }
  EXPECT_EQ(cycles, 4) << "three stages, then the bound";
  EXPECT_EQ(unit.bound(1), -1.0f);
}

TEST(SceneBoundUnit, MakesPlusZeroOfMinusZero) {
  for (const Side side : {Side::lower, Side::upper}) {
    SceneBoundUnit unit(side, {});
    CoordinateGroup group;
    group.values.fill(-0.0f);
    unit.input.push(group);
    unit.clock();
    while (!unit.done()) {
      unit.tick();
      unit.clock();
    }
    EXPECT_FALSE(std::signbit(unit.bound(0)));
  }
}

/// Reader and both units on a bus, for every width of either.
TEST(SceneBoundUnit, FindsTheBoundsOfAScene) {
  fasttree::test::Random random(1);
  for (const std::uint32_t width : {4u, 16u, 64u}) {
    for (const std::uint32_t inputs : {2u, 8u, 16u}) {
      for (const std::uint32_t triangles : {1u, 2u, 7u, 500u}) {
        fasttree::test::OwnedMesh mesh;
        for (std::uint32_t i = 0; i < triangles; ++i) {
          mesh.add(random.point(-5, 5), random.point(-3, 9), random.point(2, 3));
        }
        PaperConfig config;
        config.bus.bytes = width;
        config.scene_bound.inputs = inputs;
        test::UnitBench bench(config);
        bench.store.write(Address(0), mesh.positions.data(), mesh.positions.size() * sizeof(Vec3));
        SceneReader reader(config, bench.bus.add_port("scene"));
        SceneBoundUnit lower(Side::lower, config.scene_bound);
        SceneBoundUnit upper(Side::upper, config.scene_bound);
        reader.start_bounds(Address(0), triangles, {&lower.input, &upper.input});
        Clocks clocks;
        clocks.add(lower);
        clocks.add(upper);
        const std::uint64_t cycles = bench.run({&reader, &lower, &upper}, clocks);
        const Box3 expected = reference::scene_bound(mesh.view()).value();
        for (std::size_t a = 0; a < 3; ++a) {
          EXPECT_EQ(lower.bound(a), expected.lo[a]);
          EXPECT_EQ(upper.bound(a), expected.hi[a]);
        }
        if (triangles == 500 && width == 16 && inputs == 8) {
          EXPECT_GE(cycles, 500 * 36 / 16u);
          EXPECT_LE(cycles, 500 * 36 / 16u + 100) << "bound by the bus";
        }
      }
    }
  }
}

}  // namespace
}  // namespace fasttree::model
