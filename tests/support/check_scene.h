// SPDX-License-Identifier: Apache-2.0
// What has to hold for every builder on every scene.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/device_image.h"
#include "fasttree/trace.h"
#include "fasttree/verify.h"
#include "tests/support/rays.h"

namespace fasttree::test {

inline void expect_equal_to_brute_force(const Tree& tree, const MeshView& mesh,
                                        const BruteForce& brute, const std::vector<Ray>& rays) {
  const Tracer tracer = Tracer::create(tree, mesh).value();
  for (const Ray& ray : rays) {
    const Hit expected = brute.closest(ray);
    ASSERT_EQ(tracer.closest(ray), expected);
    ASSERT_EQ(tracer.occluded(ray), expected.hit());
  }
  // All at once: two at a time, and in packets.
  for (const RayOrder order : {RayOrder::incoherent, RayOrder::coherent}) {
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> flags(rays.size());
    tracer.closest(rays, hits, order);
    tracer.occluded(rays, flags, order);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(hits[i], tracer.closest(rays[i])) << "order " << static_cast<int>(order);
      ASSERT_EQ(flags[i] != 0, hits[i].hit()) << "order " << static_cast<int>(order);
    }
  }
}

/// Builds with both axis schedules by the fast and the reference builder, compares their bytes,
/// verifies the tree against its mesh, goes to the device image and back, and traces `ray_count`
/// hard rays against brute force.
inline void check_paper_profile(const MeshView& mesh, std::size_t ray_count) {
  Builder builder;
  const BruteForce brute(mesh);
  for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
    SCOPED_TRACE(to_string(axes));
    BuildSettings settings;
    settings.profile = Profile::paper;
    settings.axes = axes;
    const Result<Tree> fast = builder.build(mesh, settings);
    ASSERT_TRUE(fast.ok()) << fast.status().message();
    settings.implementation = Implementation::reference;
    const Result<Tree> reference = builder.build(mesh, settings);
    ASSERT_TRUE(reference.ok()) << reference.status().message();
    const Tree& tree = fast.value();
    EXPECT_EQ(tree.info(), reference.value().info());
    EXPECT_EQ(tree.hash(), reference.value().hash());
    EXPECT_TRUE(std::ranges::equal(tree.nodes(), reference.value().nodes()));
    EXPECT_TRUE(std::ranges::equal(tree.ids(), reference.value().ids()));

    const Verification verification = verify(tree, mesh);
    EXPECT_TRUE(verification.ok) << verification.invariant << ": " << verification.detail;

    const Result<DeviceImage> image = device_image_from_tree(tree);
    ASSERT_TRUE(image.ok()) << image.status().message();
    const Result<Tree> back = tree_from_device_image(image.value());
    ASSERT_TRUE(back.ok()) << back.status().message();
    EXPECT_EQ(back.value().hash(), tree.hash());

    expect_equal_to_brute_force(tree, mesh, brute, hard_rays(mesh, tree, ray_count, 1));
  }
}

/// The same for profile realtime, whose axes are fixed and which is not for the device.
inline void check_realtime_profile(const MeshView& mesh, std::size_t ray_count) {
  SCOPED_TRACE("realtime");
  Builder builder;
  BuildSettings settings;
  settings.profile = Profile::realtime;
  const Result<Tree> fast = builder.build(mesh, settings);
  ASSERT_TRUE(fast.ok()) << fast.status().message();
  settings.implementation = Implementation::reference;
  const Result<Tree> reference = builder.build(mesh, settings);
  ASSERT_TRUE(reference.ok()) << reference.status().message();
  const Tree& tree = fast.value();
  EXPECT_EQ(tree.info(), reference.value().info());
  EXPECT_TRUE(std::ranges::equal(tree.nodes(), reference.value().nodes()));
  EXPECT_TRUE(std::ranges::equal(tree.ids(), reference.value().ids()));

  const Verification verification = verify(tree, mesh);
  EXPECT_TRUE(verification.ok) << verification.invariant << ": " << verification.detail;
  expect_equal_to_brute_force(tree, mesh, BruteForce(mesh), hard_rays(mesh, tree, ray_count, 3));
}

/// The same for the surface-area-heuristic profiles, which have no second implementation.
inline void check_baseline_profile(const MeshView& mesh, Profile profile, std::size_t ray_count) {
  SCOPED_TRACE(to_string(profile));
  BuildSettings settings;
  settings.profile = profile;
  const Result<Tree> tree = Builder().build(mesh, settings);
  ASSERT_TRUE(tree.ok()) << tree.status().message();
  const Verification verification = verify(tree.value(), mesh);
  EXPECT_TRUE(verification.ok) << verification.invariant << ": " << verification.detail;
  expect_equal_to_brute_force(tree.value(), mesh, BruteForce(mesh),
                              hard_rays(mesh, tree.value(), ray_count, 2));
}

}  // namespace fasttree::test
