// SPDX-License-Identifier: Apache-2.0
// The parts of a layer against what defines them, and profile realtime against its reference.
#include "build/layers.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>

#include "fasttree/build.h"
#include "fasttree/verify.h"
#include "grid/cell_overlap.h"
#include "grid/realtime_rule.h"
#include "reference/scene_bound.h"
#include "tests/support/meshes.h"

namespace fasttree::build {
namespace {

std::vector<Box3> boxes() {
  std::vector<Box3> list;
  test::Random random(5);
  for (int i = 0; i < 200; ++i) {
    Box3 box;
    const float offset = std::ldexp(random.in(-1, 1), static_cast<int>(random.below(20)));
    for (std::size_t a = 0; a < 3; ++a) {
      box.lo[a] = offset + random.in(-1, 1);
      box.hi[a] = box.lo[a] + std::ldexp(random.in(0, 1), -static_cast<int>(random.below(24)));
    }
    list.push_back(box);
  }
  list.push_back({{0, 0, 0}, {0, 0, 0}});
  list.push_back({{-1, 0, 2}, {1, 0, 2}});
  list.push_back({{-1e-40f, 0, 0}, {1e-40f, 1e-40f, 1e-40f}});
  list.push_back({{-1e38f, -1e38f, 0}, {1e38f, 2e38f, 1e37f}});
  return list;
}

TEST(LocalGrid, EqualsTheGridAtEveryDepth) {
  for (const Box3& box : boxes()) {
    for (int depth = 0; depth <= kRealtimeRule.layer_most_depth; ++depth) {
      const Grid grid(box, AxisSchedule::longest, depth);
      for (const bool coarsened : {false, true}) {
        LocalGrid local;
        local.set(box, coarsened ? kRealtimeRule.layer_most_depth : depth);
        while (local.depth() > grid.depth()) local.coarsen();
        local.make_codes();
        ASSERT_EQ(local.depth(), grid.depth());
        for (std::size_t a = 0; a < 3; ++a) {
          ASSERT_EQ(local.bits(a), grid.bits()[a]);
          ASSERT_EQ(local.quantiser(a).scale, grid.quantiser(a).scale);
          for (std::uint32_t k = 0; k < 1u << grid.bits()[a]; ++k) {
            Cell cell{};
            cell[a] = k;
            ASSERT_EQ(local.code_bits(a, k), grid.morton_code(cell));
            ASSERT_EQ(local.coordinate_of(grid.morton_code(cell), a), k);
            if (k > 0) {
              ASSERT_EQ(local.plane(a, k), grid.plane(a, k));
            }
          }
        }
      }
    }
  }
}

// The exact part of a triangle in a cell, by clipping in binary64.
bool reaches_into(const std::array<std::array<float, 3>, 3>& triangle, const Cell& cell) {
  std::vector<std::array<double, 3>> polygon, next;
  for (const auto& p : triangle) polygon.push_back({p[0], p[1], p[2]});
  for (std::size_t a = 0; a < 3; ++a) {
    for (const double sign : {1.0, -1.0}) {
      const double plane = sign > 0 ? cell[a] : cell[a] + 1.0;
      next.clear();
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto& p = polygon[i];
        const auto& q = polygon[(i + 1) % polygon.size()];
        const double dp = sign * (p[a] - plane), dq = sign * (q[a] - plane);
        if (dp >= 0) next.push_back(p);
        if ((dp < 0) != (dq < 0) && dp != dq) {
          std::array<double, 3> r;
          for (std::size_t k = 0; k < 3; ++k) r[k] = p[k] + (q[k] - p[k]) * (dp / (dp - dq));
          r[a] = plane;
          next.push_back(r);
        }
      }
      polygon.swap(next);
    }
  }
  return !polygon.empty();
}

TEST(CellOverlap, NeverMissesACellAndLeavesMostOthersOut) {
  test::Random random(7);
  std::uint64_t reached = 0, kept = 0, all = 0;
  for (int i = 0; i < 20000; ++i) {
    std::array<std::array<float, 3>, 3> triangle;
    const float size = std::ldexp(1.0f, static_cast<int>(random.below(6)) - 2);
    const bool on_cells = random.below(4) == 0;
    const bool line = random.below(8) == 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const float at = random.in(-1, 8);
      for (auto& p : triangle) {
        p[a] = at + random.in(-size, size);
        if (on_cells) p[a] = std::round(p[a]);
      }
      if (line) triangle[2][a] = 0.5f * (triangle[0][a] + triangle[1][a]);
    }
    Cell lo, hi;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto cell = [&](float v) {
        return static_cast<std::uint32_t>(std::min(std::max(v, 0.0f), 7.0f));
      };
      lo[a] = cell(std::min({triangle[0][a], triangle[1][a], triangle[2][a]}));
      hi[a] = cell(std::max({triangle[0][a], triangle[1][a], triangle[2][a]}));
    }
    const CellOverlap overlap(triangle, lo);
    for (std::uint32_t z = lo[2]; z <= hi[2]; ++z) {
      for (std::uint32_t y = lo[1]; y <= hi[1]; ++y) {
        for (std::uint32_t x = lo[0]; x <= hi[0]; ++x) {
          const bool expected = reaches_into(triangle, {x, y, z});
          const bool found =
              overlap.at(static_cast<float>(x - lo[0]), static_cast<float>(y - lo[1]),
                         static_cast<float>(z - lo[2]));
          ASSERT_TRUE(found || !expected) << "triangle " << i;
          ++all;
          reached += expected;
          kept += found;
        }
      }
    }
  }
  EXPECT_LT(kept, reached + reached / 50) << "of " << all;
}

TEST(CellOverlap, KeepsWhatIsTooLargeToTest) {
  const CellOverlap overlap({{{-3e38f, 0, 0}, {3e38f, 0, 0}, {0, 3e38f, 9}}}, {0, 0, 0});
  EXPECT_TRUE(overlap.at(5, 5, 5));
}

TEST(LayerKernels, ScalarAndWidestAgree) {
  for (const std::uint32_t n : {1u, 2u, 15u, 16u, 17u, 41u, 400u}) {
    for (const float size : {0.02f, 0.2f, 1.0f}) {
      const test::OwnedMesh owned = test::soup(n, n, size);
      LayerTriangles triangles;
      triangles.resize(n);
      for (std::uint32_t t = 0; t < n; ++t) {
        const auto corners = owned.view().triangle(t);
        for (std::size_t k = 0; k < 9; ++k) triangles.coordinate[k][t] = corners[k / 3][k % 3];
      }
      triangles.pad();
      const Box3 box = bounds_of(triangles, Simd::scalar);
      EXPECT_EQ(bounds_of(triangles, Simd::widest), box);
      const Box3 part{box.lo, box.lo + (box.hi - box.lo) * 0.7f};
      LocalGrid grid;
      grid.set(part, 7);
      std::array<LayerCells, 2> cells;
      std::array<LayerEntries, 2> entries;
      std::array<std::uint64_t, 2> counts{};
      for (const bool coarse : {false, true}) {
        if (coarse) grid.coarsen();
        grid.make_codes();
        for (const std::size_t s : {0u, 1u}) {
          const Simd simd = s == 0 ? Simd::scalar : Simd::widest;
          cells[s].resize(n);
          counts[s] = coarse ? coarsen_layer(n, static_cast<std::size_t>(grid.axis_of_level(6)),
                                             simd, cells[s])
                             : quantise_layer(triangles, grid, simd, cells[s]);
          mask_layer(triangles, grid, simd, cells[s]);
          entries[s].count = 0;
          entries[s].resize(counts[s]);
          append_masked(0, n, grid, cells[s], simd, entries[s]);
        }
        EXPECT_EQ(counts[0], counts[1]);
        for (std::size_t i = 0; i < n; ++i) {
          for (std::size_t a = 0; a < 3; ++a) {
            ASSERT_EQ(cells[0].lo[a][i], cells[1].lo[a][i]);
            ASSERT_EQ(cells[0].hi[a][i], cells[1].hi[a][i]);
          }
          ASSERT_EQ(cells[0].mask[i], cells[1].mask[i]) << i;
        }
        ASSERT_EQ(cells[0].large_count, cells[1].large_count);
        ASSERT_EQ(entries[0].count, entries[1].count);
        for (std::size_t i = 0; i < entries[0].count; ++i) {
          ASSERT_EQ(entries[0].code[i], entries[1].code[i]);
          ASSERT_EQ(entries[0].triangle[i], entries[1].triangle[i]);
        }
      }
    }
  }
}

BuildSettings realtime() {
  BuildSettings settings;
  settings.profile = Profile::realtime;
  return settings;
}

void expect_same_bytes(const Tree& a, const Tree& b) {
  ASSERT_EQ(a.info(), b.info());
  ASSERT_TRUE(std::equal(a.nodes().begin(), a.nodes().end(), b.nodes().begin(), b.nodes().end()));
  ASSERT_TRUE(std::equal(a.ids().begin(), a.ids().end(), b.ids().begin(), b.ids().end()));
}

Tree reference_tree(const MeshView& mesh, BuildSettings settings) {
  settings.implementation = Implementation::reference;
  return Builder().build(mesh, settings).value();
}

TEST(Realtime, WritesTheReferencesBytesForEveryThreadCountAndInstructionSet) {
  const tbb::global_control threads_allowed(tbb::global_control::max_allowed_parallelism, 7);
  std::vector<test::NamedMesh> meshes = test::degenerate_meshes();
  meshes.push_back({"large soup", test::soup(20000, 7, 0.02f)});
  meshes.push_back({"dense soup", test::soup(3000, 8, 0.5f)});
  meshes.push_back({"sheet", test::sheet(90, 0.2f)});
  {
    // All but a few triangles in one cell of the top grid, and in that again, and again.
    test::OwnedMesh crowded;
    float scale = 1;
    for (std::uint64_t i = 0; i < 12; ++i, scale *= 0.05f) {
      const test::OwnedMesh part =
          test::moved(test::soup(200, i, 0.1f), {scale, scale, scale}, {0.3f, 0.4f, 0.6f});
      crowded.positions.insert(crowded.positions.end(), part.positions.begin(),
                               part.positions.end());
    }
    meshes.push_back({"crowded", crowded});
  }
  Builder builder;
  for (const auto& [name, owned] : meshes) {
    for (const int depth : {kAutoDepth, 0, 9}) {
      SCOPED_TRACE(name + " " + std::to_string(depth));
      BuildSettings settings = realtime();
      settings.depth = depth;
      const Tree expected = reference_tree(owned.view(), settings);
      const Verification verification = verify(expected, owned.view());
      EXPECT_TRUE(verification.ok) << verification.invariant << ": " << verification.detail;
      for (const int threads : {1, 2, 7}) {
        for (const Simd simd : {Simd::scalar, Simd::widest}) {
          settings.simd = simd;
          tbb::task_arena arena(threads);
          Tree tree;
          const Status status =
              arena.execute([&] { return builder.build(owned.view(), settings, tree); });
          ASSERT_TRUE(status.ok()) << status.message();
          expect_same_bytes(tree, expected);
          if (HasFatalFailure()) return;
        }
      }
    }
  }
}

TEST(Realtime, EqualsTheReferenceOnRandomMeshesAndKeepsToItsGrowth) {
  EXPECT_TRUE(rc::check("fast equals reference", [] {
    const auto triangles = *rc::gen::inRange<std::uint32_t>(0, 1500);
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    const float size = static_cast<float>(*rc::gen::inRange(0, 1000)) * 1e-3f;
    const auto scale = [] { return std::ldexp(1.0f, *rc::gen::inRange(-12, 12)); };
    const test::OwnedMesh owned = test::moved(test::soup(triangles, seed, size),
                                              {scale(), scale(), scale()}, {scale(), -scale(), 0});
    BuildSettings settings = realtime();
    settings.depth = *rc::gen::inRange(-1, 13);
    Builder builder;
    const Result<Tree> fast = builder.build(owned.view(), settings);
    RC_ASSERT(fast.ok());
    const Tree slow = reference_tree(owned.view(), settings);
    RC_ASSERT(fast.value().info() == slow.info());
    RC_ASSERT(std::equal(fast.value().nodes().begin(), fast.value().nodes().end(),
                         slow.nodes().begin(), slow.nodes().end()));
    RC_ASSERT(std::equal(fast.value().ids().begin(), fast.value().ids().end(), slow.ids().begin(),
                         slow.ids().end()));
    RC_ASSERT(verify(slow, owned.view()).invariant == "");

    const Box3 bounds = reference::scene_bound(owned.view()).value();
    const ReferenceCounts counts = count_references(owned.view(), bounds, AxisSchedule::longest);
    const int depth =
        choose_depth(counts, owned.view().triangle_count, top_grid_settings(settings)).value();
    RC_ASSERT(slow.ids().size() <=
              kRealtimeRule.whole_growth * counts.at[static_cast<std::size_t>(depth)]);
  }));
}

TEST(Realtime, IgnoresAxesAndWhatElseIsThePapers) {
  const test::OwnedMesh owned = test::soup(5000, 1, 0.05f);
  BuildSettings settings = realtime();
  const Tree expected = Builder().build(owned.view(), settings).value();
  settings.axes = AxisSchedule::longest;
  settings.extra_depth = 3;
  settings.max_growth = 1.5;
  expect_same_bytes(Builder().build(owned.view(), settings).value(), expected);
}

}  // namespace
}  // namespace fasttree::build
