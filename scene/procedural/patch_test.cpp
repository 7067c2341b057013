// SPDX-License-Identifier: Apache-2.0
#include "scene/procedural/patch.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>

#include "scene/procedural/shapes.h"

namespace fasttree::scene {
namespace {

Mesh make(const Plan& plan) {
  Result<Mesh> mesh = plan.make("test", {});
  EXPECT_TRUE(mesh.ok()) << mesh.status().message();
  return mesh.ok() ? std::move(mesh).value() : Mesh{};
}

// Edges that not exactly two triangles share, in opposite directions.
std::size_t open_edges(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.indices[i + k], b = mesh.indices[i + (k + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  return static_cast<std::size_t>(
      std::count_if(balance.begin(), balance.end(), [](const auto& e) { return e.second != 0; }));
}

TEST(Patch, CountsWhatItMakes) {
  const bool good = rc::check([] {
    Patch patch = sphere({0, 0, 0}, 1);
    patch.nu = *rc::gen::inRange(1u, 12u);
    patch.nv = *rc::gen::inRange(1u, 12u);
    patch.wrap_u = *rc::gen::arbitrary<bool>();
    const int ends = *rc::gen::inRange(0, 3);
    patch.wrap_v = ends == 1;
    patch.pole_lo = ends == 2;
    patch.pole_hi = ends == 2 && *rc::gen::arbitrary<bool>();
    const std::uint64_t triangles = patch.triangles(), vertices = patch.vertices();
    Plan plan;
    plan.add(patch);
    plan.add(patch);  // the second one begins where the first ends
    const Mesh mesh = make(plan);
    RC_ASSERT(mesh.positions.size() == 2 * vertices);
    RC_ASSERT(mesh.indices.size() == 6 * triangles);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
      const bool second = i >= 3 * triangles;
      RC_ASSERT(mesh.indices[i] >= (second ? vertices : 0));
      RC_ASSERT(mesh.indices[i] < (second ? 2 * vertices : vertices));
    }
    // Every vertex is used, but where poles leave no triangles at all.
    if (triangles > 0) {
      std::vector<bool> used(mesh.positions.size());
      for (const std::uint32_t v : mesh.indices) used[v] = true;
      RC_ASSERT(std::count(used.begin(), used.end(), true) ==
                static_cast<std::ptrdiff_t>(used.size()));
    }
  });
  ASSERT_TRUE(good);
}

TEST(Patch, ClosedSurfacesAreClosed) {
  Patch ball = sphere({1, 2, 3}, 2);
  ball.nu = 7;
  ball.nv = 5;
  Plan balls;
  balls.add(ball);
  EXPECT_EQ(open_edges(make(balls)), 0u);

  Patch knot = torus_knot([](Point p) { return p; });
  knot.nu = 40;
  knot.nv = 5;
  Plan knots;
  knots.add(knot);
  EXPECT_EQ(open_edges(make(knots)), 0u);

  Patch open = knot;
  open.wrap_u = false;
  Plan opens;
  opens.add(open);
  EXPECT_EQ(open_edges(make(opens)), 2u * 5u);
}

TEST(Patch, SphereFacesOutward) {
  Patch ball = sphere({0, 0, 0}, 1);
  ball.nu = 16;
  ball.nv = 8;
  Plan plan;
  plan.add(ball);
  const Mesh mesh = make(plan);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
               c = mesh.positions[mesh.indices[i + 2]];
    EXPECT_GT(dot(cross(b - a, c - a), a + b + c), 0.0f);
    EXPECT_NEAR(dot(a, a), 1.0f, 1e-5f);
  }
}

TEST(Plan, DistributesByWeight) {
  Plan plan;
  plan.add(sphere({0, 0, 0}, 1), Share{3, 2, 3, 2});
  plan.add(torus_knot([](Point p) { return p; }), Share{1, 8, 3, 3});
  plan.distribute(40000);
  EXPECT_NEAR(static_cast<double>(plan.triangles()), 40000, 200);
  const Mesh mesh = make(plan);
  EXPECT_EQ(mesh.indices.size(), 3 * plan.triangles());
  EXPECT_EQ(mesh.positions.size(), plan.vertices());
}

TEST(Plan, ManySmallSharesStillSumUp) {
  Plan plan;
  for (int i = 0; i < 1000; ++i) plan.add(sphere({0, 0, 0}, 1), Share{1, 1.5, 3, 2});
  plan.distribute(100000);
  EXPECT_NEAR(static_cast<double>(plan.triangles()), 100000, 200);
}

TEST(Plan, RefusesBeforeAllocating) {
  Plan plan;
  plan.add(quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, 100, 100));
  LoadSettings settings;
  settings.memory_limit_bytes = 101 * 101 * 12 + 20000 * 12;
  EXPECT_TRUE(plan.make("quad", settings).ok());
  --settings.memory_limit_bytes;
  const Result<Mesh> refused = plan.make("quad", settings);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.status().code(), StatusCode::resource_limit);

  Plan huge;
  huge.add(quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, 60000, 60000));
  EXPECT_EQ(huge.make("quad", {}).status().code(), StatusCode::resource_limit);
}

TEST(Plan, ReportsProgressAndCancels) {
  Plan plan;
  plan.add(quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, 1000, 1000));
  LoadSettings settings;
  double last = 0;
  int calls = 0;
  settings.progress = [&](const char*, double fraction) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1.0);
    last = fraction;
    ++calls;
    return true;
  };
  EXPECT_TRUE(plan.make("quad", settings).ok());
  EXPECT_GT(calls, 3);
  EXPECT_GT(last, 0.9);

  int left = 2;
  settings.progress = [&](const char*, double) { return --left > 0; };
  EXPECT_EQ(plan.make("quad", settings).status().code(), StatusCode::cancelled);
  EXPECT_EQ(left, 0);
}

TEST(Plan, SameForEveryNumberOfThreads) {
  // Otherwise there are no more threads than processors.
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  Plan plan;
  plan.add(torus_knot([](Point p) { return p; }), Share{1, 10, 3, 3});
  plan.distribute(200000);
  Mesh one, many;
  tbb::task_arena(1).execute([&] { one = make(plan); });
  tbb::task_arena(7).execute([&] { many = make(plan); });
  EXPECT_EQ(one.positions, many.positions);
  EXPECT_EQ(one.indices, many.indices);
}

}  // namespace
}  // namespace fasttree::scene
