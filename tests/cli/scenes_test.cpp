// SPDX-License-Identifier: Apache-2.0
// Every test scene, both axis schedules: the tree is right. Acceptance runs use more rays.
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "runner.h"

namespace fasttree::cli {
namespace {

class Scene : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(Scene, HasARightTree) {
  const auto [name, axes] = GetParam();
  const std::string path = real_scene(name);
  if (path.empty()) GTEST_SKIP() << name << " is not on this machine";
  // Brute force for all rays, and about as long for a large scene as for a small one.
  const bool large = std::string(name).rfind("dragon", 0) == 0;
  const int rays = large ? 330 : 1100;
  const auto json = run_json({"verify", path, "--profile", "paper", "--axes", axes, "--oracle",
                              "brute", "--rays", std::to_string(rays)});
  EXPECT_EQ(json["ok"], true);
  EXPECT_EQ(json["rays"]["brute_force_checked"], rays);
  EXPECT_GT(json["rays"]["hits"], rays / 3);
  if (!large || run_json({"info"})["embree"].is_null()) return;
  const auto more = run_json({"verify", path, "--profile", "paper", "--axes", axes, "--oracle",
                              "embree", "--rays", "11000", "--seed", "2"});
  EXPECT_EQ(more["rays"]["wrong"], 0);
}

INSTANTIATE_TEST_SUITE_P(Shared, Scene,
                         testing::Combine(testing::Values("bunny.ply", "sibenik.ply", "sponza.ply",
                                                          "buddha_100k.ply", "dragon_res2.ply",
                                                          "dragon.ply", "pigman_run/000.ply",
                                                          "pigman_run/011.ply"),
                                          testing::Values("cyclic", "longest")));

}  // namespace
}  // namespace fasttree::cli
