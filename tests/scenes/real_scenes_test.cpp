// SPDX-License-Identifier: Apache-2.0
// The scenes the paper and the field use, where they are present (FASTTREE_TEST_SCENES).
#include <gtest/gtest.h>

#include <filesystem>

#include "scene/scene.h"
#include "tests/support/check_scene.h"

namespace fasttree {
namespace {

struct RealScene {
  const char* file;
  std::uint32_t triangles;
  std::size_t rays;
  bool exact_baseline;  ///< the exact builder takes seconds on the large ones
};

void PrintTo(const RealScene& scene, std::ostream* out) {
  *out << scene.file;
}

class RealScenes : public testing::TestWithParam<RealScene> {};

TEST_P(RealScenes, BuildVerifyAndTrace) {
  const std::string path = std::string(FASTTREE_TEST_SCENES) + "/" + GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Result<scene::Mesh> loaded = scene::load_scene(path);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const MeshView mesh = loaded.value().view();
  ASSERT_EQ(mesh.triangle_count, GetParam().triangles);
  test::check_paper_profile(mesh, GetParam().rays);
  test::check_realtime_profile(mesh, GetParam().rays);
  test::check_baseline_profile(mesh, Profile::sah_binned, GetParam().rays / 4);
  if (GetParam().exact_baseline) {
    test::check_baseline_profile(mesh, Profile::sah_exact, GetParam().rays / 4);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, RealScenes,
                         testing::Values(RealScene{"bunny.ply", 69451, 4200, true},
                                         RealScene{"sibenik.ply", 80479, 4200, true},
                                         RealScene{"sponza.ply", 66447, 4200, true},
                                         RealScene{"buddha_100k.ply", 100000, 4200, true},
                                         RealScene{"pigman_run/000.ply", 35706, 4200, true},
                                         RealScene{"pigman_run/013.ply", 35706, 4200, true},
                                         RealScene{"dragon.ply", 871414, 700, false}));

// Counts of the first prototype of this algorithm, exact since the definition has not changed:
// they pin the bytes down from outside.
struct Counts {
  const char* file;
  int depth;
  std::uint64_t references;
  std::uint64_t leaves;
};

TEST(RealScenesCounts, ReferencesAndLeavesATriangle) {
  for (const Counts& expected :
       {Counts{"bunny.ply", 18, 216678, 20396}, Counts{"dragon.ply", 22, 2368741, 184090}}) {
    const std::string path = std::string(FASTTREE_TEST_SCENES) + "/" + expected.file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const scene::Mesh loaded = scene::load_scene(path).value();
    for (const AxisSchedule axes : {AxisSchedule::cyclic, AxisSchedule::longest}) {
      BuildSettings settings;
      settings.profile = Profile::paper;
      settings.axes = axes;
      settings.depth = expected.depth;
      const Tree tree = Builder().build(loaded.view(), settings).value();
      EXPECT_EQ(tree.ids().size(), expected.references) << expected.file;
      EXPECT_EQ(tree.leaf_count(), expected.leaves) << expected.file;
    }
  }
}

}  // namespace
}  // namespace fasttree
