// SPDX-License-Identifier: Apache-2.0
// Every builder on every built-in scene: what a machine without any mesh file can check.
#include <gtest/gtest.h>

#include "scene/procedural/procedural.h"
#include "scene/scene.h"
#include "tests/support/check_scene.h"

namespace fasttree {
namespace {

TEST(BuiltInScenes, BuildVerifyAndTrace) {
  for (const scene::ProceduralInfo& entry : scene::procedural_scenes()) {
    const std::string spec = std::string("scene:") + entry.name + ":3000";
    SCOPED_TRACE(spec);
    const Result<scene::Mesh> loaded = scene::load_scene(spec);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const MeshView mesh = loaded.value().view();
    test::check_paper_profile(mesh, 2800);
    test::check_realtime_profile(mesh, 2800);
    test::check_baseline_profile(mesh, Profile::sah_binned, 1400);
    test::check_baseline_profile(mesh, Profile::sah_exact, 1400);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace fasttree
