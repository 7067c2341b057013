// SPDX-License-Identifier: Apache-2.0
// Batches through every instruction set: rays two at a time and in packets, against brute force.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/trace.h"
#include "tests/support/meshes.h"
#include "tests/support/rays.h"

namespace fasttree {
namespace {

using test::OwnedMesh;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr RayOrder kOrders[] = {RayOrder::incoherent, RayOrder::coherent};

const std::vector<Profile> kProfiles{Profile::paper, Profile::realtime, Profile::sah_exact,
                                     Profile::sah_binned};

// Calls run() with each instruction set in turn.
template <typename Run>
void for_each_instruction_set(const Run& run) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    run();
    if (testing::Test::HasFatalFailure()) break;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

bool same(const Hit& a, const Hit& b) {
  return a.triangle == b.triangle &&
         std::bit_cast<std::uint32_t>(a.t) == std::bit_cast<std::uint32_t>(b.t) &&
         std::bit_cast<std::uint32_t>(a.u) == std::bit_cast<std::uint32_t>(b.u) &&
         std::bit_cast<std::uint32_t>(a.v) == std::bit_cast<std::uint32_t>(b.v);
}

std::vector<Hit> expected_hits(const MeshView& mesh, const std::vector<Ray>& rays) {
  const BruteForce brute(mesh);
  std::vector<Hit> hits;
  for (const Ray& ray : rays) hits.push_back(brute.closest(ray));
  return hits;
}

void expect_hits(const Tracer& tracer, const std::vector<Ray>& rays,
                 const std::vector<Hit>& expected) {
  for (const RayOrder order : kOrders) {
    std::vector<Hit> hits(rays.size(), Hit{1, 2, 3, 4});
    std::vector<std::uint8_t> flags(rays.size(), std::uint8_t{7});
    tracer.closest(rays, hits, order);
    tracer.occluded(rays, flags, order);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray& r = rays[i];
      ASSERT_TRUE(same(hits[i], expected[i]))
          << "ray " << i << " of " << rays.size() << " order " << static_cast<int>(order) << " ids "
          << hits[i].triangle << ' ' << expected[i].triangle << " origin " << r.origin.x << ' '
          << r.origin.y << ' ' << r.origin.z << " direction " << r.direction.x << ' '
          << r.direction.y << ' ' << r.direction.z << " t " << r.t_min << ' ' << r.t_max;
      ASSERT_EQ(flags[i], expected[i].hit() ? 1 : 0) << "ray " << i << " of " << rays.size();
    }
  }
}

void check(const Tree& tree, const MeshView& mesh, const std::vector<Ray>& rays) {
  const std::vector<Hit> expected = expected_hits(mesh, rays);
  for_each_instruction_set([&] {
    const Tracer tracer = Tracer::create(tree, mesh).value();
    expect_hits(tracer, rays, expected);
  });
}

Tree built(const MeshView& mesh, Profile profile) {
  BuildSettings settings;
  settings.profile = profile;
  return Builder().build(mesh, settings).value();
}

// Tiles of 8 x 8 rays from `eye`, one after the other.
std::vector<Ray> camera(Vec3 eye, Vec3 forward, Vec3 right, Vec3 up, int tiles) {
  std::vector<Ray> rays;
  const int size = 8 * tiles;
  for (int tile = 0; tile < tiles * tiles; ++tile) {
    for (int i = 0; i < 64; ++i) {
      const int x = 8 * (tile % tiles) + i % 8, y = 8 * (tile / tiles) + i / 8;
      const float s = (static_cast<float>(x) + 0.5f) / static_cast<float>(size) * 2 - 1;
      const float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(size) * 2 - 1;
      rays.push_back({eye, 0, forward + right * s + up * t});
    }
  }
  return rays;
}

std::vector<Ray> cameras(int tiles) {
  std::vector<Ray> rays;
  const auto add = [&](const std::vector<Ray>& more) {
    rays.insert(rays.end(), more.begin(), more.end());
  };
  add(camera({0.5f, 0.5f, 3}, {0, 0, -1}, {0.3f, 0, 0}, {0, 0.3f, 0}, tiles));    // at it
  add(camera({0.5f, 0.5f, 0.5f}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, tiles));        // inside
  add(camera({-2, 0.4f, 0.3f}, {1, 0, 0}, {0, 0.9f, 0}, {0, 0, 0.9f}, tiles));    // and past it
  add(camera({900, 700, 800}, {-900, -700, -800}, {0, 2, 0}, {0, 0, 2}, tiles));  // far
  add(camera({0.5f, 3, 0.5f}, {0, 1, 0}, {0.3f, 0, 0}, {0, 0, 0.3f}, tiles));     // away from it
  return rays;
}

TEST(WideTrace, RunsMoreThanOneInstructionSet) {
  std::vector<std::int64_t> seen;
  for_each_instruction_set([&] { seen.push_back(hwy::SupportedTargets()); });
  EXPECT_FALSE(seen.empty());
  for (const std::int64_t targets : seen) EXPECT_NE(targets, 0);
#if HWY_ARCH_X86
  EXPECT_GT(seen.size(), 1u);
#endif
}

TEST(WideTrace, HardRaysOverEveryDegenerateMesh) {
  for (const auto& [name, owned] : test::degenerate_meshes()) {
    for (const Profile profile : kProfiles) {
      SCOPED_TRACE(name + " " + to_string(profile));
      const Tree tree = built(owned.view(), profile);
      check(tree, owned.view(), test::hard_rays(owned.view(), tree, 700, 11));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(WideTrace, BatchesOfAnySize) {
  const OwnedMesh owned = test::soup(800, 3, 0.1f);
  const Tree tree = built(owned.view(), Profile::realtime);
  const std::vector<Ray> hard = test::hard_rays(owned.view(), tree, 1100, 12);
  for (const std::size_t size : {0, 1, 2, 15, 16, 17, 63, 64, 65, 127, 128, 129, 1000, 1100}) {
    check(tree, owned.view(), {hard.begin(), hard.begin() + static_cast<std::ptrdiff_t>(size)});
    if (HasFatalFailure()) return;
  }
}

TEST(WideTrace, CameraRays) {
  for (const OwnedMesh& owned :
       {test::soup(3000, 5, 0.05f), test::sheet(30, 0.3f), test::soup(20, 6, 0.5f)}) {
    for (const Profile profile : kProfiles) {
      SCOPED_TRACE(to_string(profile));
      const Tree tree = built(owned.view(), profile);
      std::vector<Ray> rays = cameras(4);
      check(tree, owned.view(), rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        rays[i].t_min = 0.2f + 0.5f * static_cast<float>(i % 5);
        rays[i].t_max = rays[i].t_min + static_cast<float>(i % 7);
      }
      check(tree, owned.view(), rays);
      if (HasFatalFailure()) return;
    }
  }
}

// A ray that hits nothing, or goes elsewhere, among others changes nothing for them.
TEST(WideTrace, StrayRaysInPackets) {
  const OwnedMesh owned = test::sheet(20, 0.3f);
  const Tree tree = built(owned.view(), Profile::realtime);
  const Vec3 o{0.5f, 0.5f, 2};
  const std::vector<Ray> strays{{o, 0, {0, 0, 0}},
                                {o, 0, {0, kNaN, -1}},
                                {o, 0, {kNaN, kNaN, kNaN}},
                                {o, 0, {0, 0, -kInfinity}},
                                {o, 0, {kInfinity, 0, -1}},
                                {{kNaN, 0, 0}, 0, {0, 0, -1}},
                                {{0, 0, kInfinity}, 0, {0, 0, -1}},
                                {{-kInfinity, 0, 0}, 0, {0, 0, -1}},
                                {o, kNaN, {0, 0, -1}},
                                {o, 0, {0, 0, -1}, kNaN},
                                {o, kNaN, {0, 0, -1}, kNaN},
                                {o, 3, {0, 0, -1}, 1},
                                {o, 0, {0, 0, 1}},
                                {o, 0, {-0.0f, -0.0f, -1}},
                                {o, 0, {0, -0.0f, -1e-42f}},
                                {o, 0, {0, 0, -1e-30f}},
                                {o, 0, {1e30f, 0, -1e30f}},
                                {{0.5f, 0.5f, 1e20f}, 0, {0, 0, -1}},
                                {o, -kInfinity, {0, 0, 1}},
                                {o, kInfinity, {0, 0, -1}},
                                {o, 0, {0, 0, -1}, -kInfinity}};
  for (const Ray& stray : strays) {
    // Packets that wander out of the mesh, so that some of each packet's rays miss.
    for (const float aside : {0.0f, 0.6f, 0.9f, 3.0f}) {
      for (const std::size_t place : {0, 1, 5, 16, 17, 31, 40, 62, 63}) {
        std::vector<Ray> rays =
            camera({0.5f + aside, 0.5f, 2}, {0, 0, -1}, {0.2f, 0, 0}, {0, 0.2f, 0}, 1);
        rays[place] = stray;
        if (place % 2 == 1) rays[place / 2] = stray;
        const std::vector<Hit> expected = expected_hits(owned.view(), rays);
        for_each_instruction_set(
            [&] { expect_hits(Tracer::create(tree, owned.view()).value(), rays, expected); });
        if (HasFatalFailure()) return;
      }
    }
  }
}

// One ray of a packet hits, and those after it have gone by: bounds must not forget the first.
TEST(WideTrace, NumbersThatAreNoneDoNotHideOtherRays) {
  const OwnedMesh owned = test::sheet(8, 0);
  const Tree tree = built(owned.view(), Profile::realtime);
  for (const int field : {0, 1, 2, 3, 4, 5, 6, 7}) {
    for (std::size_t hitting = 0; hitting < 64; ++hitting) {
      std::vector<Ray> rays(64, Ray{{5, 5, 2}, 3, {0.001f, 0.001f, -1}, 4});
      for (std::size_t i = 0; i < 64; i += 3) {
        Ray& r = rays[i];
        float* const fields[8] = {&r.origin.x,    &r.origin.y,    &r.origin.z,    &r.t_min,
                                  &r.direction.x, &r.direction.y, &r.direction.z, &r.t_max};
        if (field != 3 && field != 7) r.origin = {5, 5, 2};
        *fields[field] = kNaN;
      }
      rays[hitting] = {{0.3f, 0.4f, 2}, 0, {0.001f, 0.001f, -1}};
      if (field == 7 || field == 3) {
        for (Ray& r : rays) r.origin = {0.3f, 0.4f, 2};
      }
      check(tree, owned.view(), rays);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(WideTrace, AxisParallelRays) {
  for (const OwnedMesh& owned : {test::soup(1000, 7, 0.1f), test::snapped_soup(300, 8, 8)}) {
    const Tree tree = built(owned.view(), Profile::realtime);
    std::vector<Ray> rays;
    for (std::size_t a = 0; a < 3; ++a) {
      for (const float way : {1.0f, -1.0f}) {
        for (const float zero : {0.0f, -0.0f}) {
          for (int i = 0; i < 64; ++i) {
            Ray ray;
            for (std::size_t b = 0; b < 3; ++b) ray.direction[b] = zero;
            ray.direction[a] = way;
            ray.origin[(a + 1) % 3] = 0.125f * static_cast<float>(i % 8);
            ray.origin[(a + 2) % 3] = 0.125f * static_cast<float>(i / 8);
            ray.origin[a] = way > 0 ? -1.0f : 2.0f;
            rays.push_back(ray);
          }
        }
      }
    }
    check(tree, owned.view(), rays);
    // Zeros of both signs and all axes in one packet.
    std::vector<Ray> mixed;
    for (std::size_t i = 0; i < rays.size(); ++i) mixed.push_back(rays[i * 331 % rays.size()]);
    check(tree, owned.view(), mixed);
    if (HasFatalFailure()) return;
  }
}

// Origins beyond 2^40, directions of any length, tiny and huge scenes: not all rays are tame.
TEST(WideTrace, RaysThatAreNotTame) {
  for (const float scale : {1.0f, 1e-15f, 1e15f}) {
    const OwnedMesh owned = test::moved(test::soup(500, 9, 0.2f), {scale, scale, scale}, {});
    const Tree tree = built(owned.view(), Profile::realtime);
    test::Random random(4);
    std::vector<Ray> rays = test::hard_rays(owned.view(), tree, 1200, 14);
    for (Ray& ray : rays) {
      if (random.below(2) == 0) {
        const float length = std::pow(10.0f, random.in(-30, 30)) / scale;
        if (std::isfinite(length)) ray.direction = ray.direction * length;
      }
      if (random.below(3) == 0) {
        ray.origin = random.point(-1, 1) * (std::pow(10.0f, random.in(8, 18)) * scale);
        ray.direction = random.point(0, scale) - ray.origin;
      }
    }
    check(tree, owned.view(), rays);
    if (HasFatalFailure()) return;
    // Whole packets of one length.
    for (const float length : {1e-30f, 1e-20f, 1e-13f, 1e-12f, 1e12f, 1e13f, 1e20f, 1e30f}) {
      std::vector<Ray> tiles = cameras(1);
      for (Ray& ray : tiles) {
        ray.origin = ray.origin * scale;
        ray.direction = ray.direction * length;
      }
      check(tree, owned.view(), tiles);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(WideTrace, LargeLeaves) {
  OwnedMesh owned;
  for (int i = 0; i < 4200; ++i) owned.add({0, 0, 0}, {1, 0, 0.5f}, {0, 1, 0.25f});
  const Tree tree = built(owned.view(), Profile::realtime);
  check(tree, owned.view(), cameras(1));
}

TEST(WideTrace, UpdateTakesANewFrame) {
  Tracer tracer;
  test::Random random(3);
  // Larger and smaller ones in turn, in one memory.
  for (const std::uint32_t triangles : {500u, 2000u, 10u, 0u, 1500u}) {
    const OwnedMesh owned = test::soup(triangles, triangles, 0.1f);
    const Tree tree = built(owned.view(), Profile::realtime);
    ASSERT_TRUE(tracer.update(tree, owned.view()).ok());
    std::vector<Ray> rays = cameras(1);
    for (const Ray& ray : test::hard_rays(owned.view(), tree, 500, 2)) rays.push_back(ray);
    expect_hits(tracer, rays, expected_hits(owned.view(), rays));
    if (HasFatalFailure()) return;
  }
}

TEST(WideTrace, AnErrorLeavesTheEmptyTracer) {
  const OwnedMesh owned = test::sheet(4, 0), other = test::sheet(5, 0);
  const Tree tree = built(owned.view(), Profile::realtime);
  const Ray ray{{0.5f, 0.4f, 2}, 0, {0, 0, -1}};
  Tracer tracer = Tracer::create(tree, owned.view()).value();
  EXPECT_TRUE(tracer.closest(ray).hit());
  EXPECT_EQ(tracer.update(tree, other.view()).code(), StatusCode::invalid_argument);
  EXPECT_FALSE(tracer.closest(ray).hit());
  EXPECT_FALSE(tracer.occluded(ray));
  ASSERT_TRUE(tracer.update(tree, owned.view()).ok());
  EXPECT_TRUE(tracer.closest(ray).hit());
}

TEST(WideTrace, CanBeMoved) {
  const OwnedMesh owned = test::sheet(4, 0);
  const Tree tree = built(owned.view(), Profile::realtime);
  const Ray ray{{0.5f, 0.4f, 2}, 0, {0, 0, -1}};
  Tracer first = Tracer::create(tree, owned.view()).value();
  Tracer second = std::move(first);
  EXPECT_TRUE(second.closest(ray).hit());
  ASSERT_TRUE(first.update(tree, owned.view()).ok());  // NOLINT(bugprone-use-after-move)
  EXPECT_TRUE(first.closest(ray).hit());
  second = std::move(first);
  EXPECT_TRUE(second.closest(ray).hit());
}

}  // namespace
}  // namespace fasttree
