// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <bit>
#include <cmath>
#include <limits>
#include <sstream>

#include "fasttree/build.h"
#include "fasttree/trace.h"
#include "tests/support/meshes.h"
#include "tests/support/rays.h"

namespace fasttree {
namespace {

std::string text(const Ray& ray) {
  std::ostringstream s;
  s << std::hexfloat << "origin " << ray.origin.x << ' ' << ray.origin.y << ' ' << ray.origin.z
    << " direction " << ray.direction.x << ' ' << ray.direction.y << ' ' << ray.direction.z << " t "
    << ray.t_min << ' ' << ray.t_max;
  return s.str();
}

// Bit for bit: t, id, u and v, and the answer to any-hit.
void expect_equal_to_brute_force(const Tree& tree, const MeshView& mesh,
                                 const std::vector<Ray>& rays) {
  const Tracer tracer = Tracer::create(tree, mesh).value();
  for (const Ray& ray : rays) {
    const Hit expected = brute_force_closest(mesh, ray);
    const Hit found = tracer.closest(ray);
    ASSERT_EQ(std::bit_cast<std::uint32_t>(found.t), std::bit_cast<std::uint32_t>(expected.t))
        << text(ray) << " ids " << found.triangle << ' ' << expected.triangle;
    ASSERT_EQ(found, expected) << text(ray);
    ASSERT_EQ(tracer.occluded(ray), brute_force_occluded(mesh, ray)) << text(ray);
    ASSERT_EQ(tracer.occluded(ray), expected.hit()) << text(ray);
  }
}

const std::vector<Profile> kProfiles{Profile::paper, Profile::realtime, Profile::sah_exact,
                                     Profile::sah_binned};

TEST(Tracer, EqualsBruteForceOnHardRaysOverEveryDegenerateMesh) {
  Builder builder;
  for (const auto& [name, owned] : test::degenerate_meshes()) {
    for (const Profile profile : kProfiles) {
      for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
        if (profile != Profile::paper && axes != AxisSchedule::cyclic) continue;
        SCOPED_TRACE(name + " " + to_string(profile) + " " + to_string(axes));
        BuildSettings settings;
        settings.profile = profile;
        settings.axes = axes;
        const Result<Tree> tree = builder.build(owned.view(), settings);
        ASSERT_TRUE(tree.ok()) << tree.status().message();
        expect_equal_to_brute_force(tree.value(), owned.view(),
                                    test::hard_rays(owned.view(), tree.value(), 1400, 5));
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(Tracer, EqualsBruteForceOnHardRaysOverDeepTrees) {
  Builder builder;
  for (const test::OwnedMesh& owned :
       {test::soup(1500, 21, 0.05f), test::sheet(25, 0.3f), test::snapped_soup(300, 23, 16),
        test::moved(test::sheet(20, 0), {1, 1, 1}, {0, 0, 0.5f})}) {
    for (const Profile profile : kProfiles) {
      for (const int depth : {kAutoDepth, 18}) {
        if (profile != Profile::paper && depth != kAutoDepth) continue;
        SCOPED_TRACE(std::string(to_string(profile)) + " " + std::to_string(depth));
        BuildSettings settings;
        settings.profile = profile;
        settings.depth = depth;
        const Tree tree = builder.build(owned.view(), settings).value();
        expect_equal_to_brute_force(tree, owned.view(),
                                    test::hard_rays(owned.view(), tree, 7000, 6));
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(Tracer, BreaksTiesByTheLowestId) {
  test::OwnedMesh owned;
  for (int i = 0; i < 5; ++i) owned.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Tree tree = Builder().build(owned.view()).value();
  const Hit hit =
      Tracer::create(tree, owned.view()).value().closest({{0.2f, 0.2f, 1}, 0, {0, 0, -1}});
  EXPECT_EQ(hit.triangle, 0u);
  EXPECT_EQ(hit.t, 1.0f);
}

TEST(Tracer, InvalidRaysHitNothing) {
  const test::OwnedMesh owned = test::sheet(4, 0.1f);
  const Tree tree = Builder().build(owned.view()).value();
  const Tracer tracer = Tracer::create(tree, owned.view()).value();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const Vec3 o{0.5f, 0.5f, 2};
  EXPECT_TRUE(tracer.closest({o, 0, {0, 0, -1}}).hit());
  for (const Ray& ray : {Ray{o, 0, {0, 0, 0}}, Ray{o, 0, {0, nan, -1}}, Ray{o, 0, {0, 0, -inf}},
                         Ray{{inf, 0, 0}, 0, {-1, 0, 0}}, Ray{o, nan, {0, 0, -1}},
                         Ray{o, 3, {0, 0, -1}, 1}, Ray{o, 0, {0, 0, -1}, nan}}) {
    EXPECT_FALSE(tracer.closest(ray).hit()) << text(ray);
    EXPECT_FALSE(tracer.occluded(ray)) << text(ray);
    EXPECT_FALSE(brute_force_closest(owned.view(), ray).hit()) << text(ray);
  }
}

// Directions whose components span all magnitudes, origins near and far.
TEST(Tracer, EqualsBruteForceForExtremeDirectionsAndOrigins) {
  const test::OwnedMesh owned = test::soup(600, 31, 0.2f);
  Builder builder;
  for (const Profile profile : kProfiles) {
    BuildSettings settings;
    settings.profile = profile;
    const Tree tree = builder.build(owned.view(), settings).value();
    test::Random random(8);
    std::vector<Ray> rays;
    for (int i = 0; i < 6000; ++i) {
      const float far = std::pow(10.0f, random.in(-2, 7));
      Ray ray;
      ray.origin = random.point(-far, far);
      ray.direction = random.point(0, 1) - ray.origin;
      if (i % 3 == 0) {
        for (std::size_t a = 0; a < 3; ++a) {
          ray.direction[a] = random.in(-1, 1) * std::pow(10.0f, random.in(-42, 3));
        }
      }
      if (i % 3 == 1) ray.direction = ray.direction * std::pow(10.0f, random.in(-30, 25));
      rays.push_back(ray);
    }
    expect_equal_to_brute_force(tree, owned.view(), rays);
    if (HasFatalFailure()) return;
  }
}

TEST(Tracer, ManyRaysEqualOneByOneForEveryThreadCount) {
  const tbb::global_control threads_allowed(tbb::global_control::max_allowed_parallelism, 7);
  const test::OwnedMesh owned = test::sheet(40, 0.2f);
  const Tree tree = Builder().build(owned.view()).value();
  const Tracer tracer = Tracer::create(tree, owned.view()).value();
  const std::vector<Ray> rays = test::hard_rays(owned.view(), tree, 3000, 9);
  for (const int threads : {1, 2, 7}) {
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> flags(rays.size());
    tbb::task_arena arena(threads);
    arena.execute([&] {
      tracer.closest(rays, hits);
      tracer.occluded(rays, flags);
    });
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(hits[i], tracer.closest(rays[i]));
      ASSERT_EQ(flags[i] != 0, tracer.occluded(rays[i]));
    }
  }
}

TEST(Tracer, RefusesATreeOfAnotherMesh) {
  const test::OwnedMesh owned = test::soup(10, 1, 0.1f);
  const Tree tree = Builder().build(owned.view()).value();
  const test::OwnedMesh other = test::soup(11, 1, 0.1f);
  EXPECT_EQ(Tracer::create(tree, other.view()).status().code(), StatusCode::invalid_argument);
}

}  // namespace
}  // namespace fasttree
