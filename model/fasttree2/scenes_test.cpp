// SPDX-License-Identifier: Apache-2.0
// Real scenes, where they are at hand: the library's tree, and no slower than we say.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "fasttree/build.h"
#include "model/config/machine_config.h"
#include "model/fasttree2/machine.h"
#include "scene/scene.h"

namespace fasttree::model {
namespace {

struct Expectation {
  const char* scene;
  const char* config;
  bool bounds_given;
  double cycles;     ///< a triangle, at most
  double bandwidth;  ///< share of the memory's peak, at least
};

class FastTree2Scenes : public testing::TestWithParam<Expectation> {};

TEST_P(FastTree2Scenes, BuildsTheLibrarysTreeInTime) {
  const Expectation& e = GetParam();
  const char* const folder = std::getenv("FASTTREE_SCENES");
  const std::string path =
      std::string(folder != nullptr ? folder : FASTTREE_SCENES) + "/" + e.scene + ".ply";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << e.scene << ".ply is not there; FASTTREE_SCENES names the folder of scenes";
  }
  const auto mesh = scene::load_scene(path, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  MachineConfig config = load_config(e.config).value();
  config.fasttree2.bounds_given = e.bounds_given;
  const auto simulation = simulate_fasttree2(mesh.value().view(), config, {});
  ASSERT_TRUE(simulation.ok()) << simulation.status().message();
  const SimulationResult& result = simulation.value();

  BuildSettings settings;
  settings.profile = Profile::paper;
  EXPECT_EQ(result.tree.hash(), Builder().build(mesh.value().view(), settings).value().hash());

  const auto cycles = static_cast<double>(result.cycles);
  EXPECT_LE(cycles / static_cast<double>(result.triangles), e.cycles);
  const double peak = result.memory_traits.peak_gb_s * 1e3 / result.clock_mhz;  // bytes a cycle
  const double bytes = static_cast<double>(result.memory.read_bytes) +
                       static_cast<double>(result.memory.write_bytes);
  EXPECT_GE(bytes / cycles / peak, e.bandwidth);
}

INSTANTIATE_TEST_SUITE_P(, FastTree2Scenes,
                         testing::Values(Expectation{"bunny", "fasttree-2", false, 5.3, 0.80},
                                         Expectation{"sibenik", "fasttree-2", false, 6.0, 0.80},
                                         Expectation{"dragon", "fasttree-2", false, 5.4, 0.85},
                                         Expectation{"sponza", "fasttree-2", false, 6.7, 0.77},
                                         Expectation{"bunny", "fasttree-2", true, 4.0, 0.70},
                                         Expectation{"dragon", "fasttree-2", true, 4.0, 0.80},
                                         Expectation{"bunny", "fasttree-2-small", false, 6.0, 0.75},
                                         Expectation{"sibenik", "fasttree-2-small", false, 7.5,
                                                     0.70}),
                         [](const auto& test) {
                           std::string name = std::string(test.param.scene) + "_" +
                                              test.param.config +
                                              (test.param.bounds_given ? "_bounds_given" : "");
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

}  // namespace
}  // namespace fasttree::model
