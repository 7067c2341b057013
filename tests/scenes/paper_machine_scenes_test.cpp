// SPDX-License-Identifier: Apache-2.0
// The accelerator of the paper on the scenes the paper and the field use, where they are present
// (FASTTREE_TEST_SCENES): every array as the reference's, and cycles a triangle as published.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <iostream>

#include "model/system/compare_reference.h"
#include "model/system/paper_machine.h"
#include "scene/scene.h"

namespace fasttree::model {
namespace {

struct PaperScene {
  const char* file;
  double published;  ///< cycles a triangle, from build time and clock of the FPGA; 0: not published
};

void PrintTo(const PaperScene& scene, std::ostream* out) {
  *out << scene.file;
}

class PaperScenes : public testing::TestWithParam<PaperScene> {};

void print(const SimulationResult& result) {
  const auto n = static_cast<double>(result.triangles);
  std::cout << result.config << ": " << static_cast<double>(result.cycles) / n
            << " cycles a triangle";
  for (const StageRecord& stage : result.stages) {
    std::cout << ", " << stage.name << ' '
              << static_cast<double>(stage.end_cycle - stage.begin_cycle) / n;
  }
  std::cout << '\n';
}

TEST_P(PaperScenes, MakeTheReferencesArraysInThePapersCycles) {
  const std::string path = std::string(FASTTREE_TEST_SCENES) + "/" + GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Result<scene::Mesh> loaded = scene::load_scene(path);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  for (const char* name : {"paper-fpga", "paper-asic65"}) {
    const MachineConfig config = load_config(name).value();
    SimulationOptions options;
    options.keep_arrays = true;
    const std::clock_t begin = std::clock();
    const Result<SimulationResult> run = simulate_paper(loaded.value().view(), config, options);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    ASSERT_TRUE(run.ok()) << run.status().message();
    const SimulationResult& result = run.value();
    print(result);
    std::cout << "simulated at " << static_cast<double>(result.cycles) / seconds / 1e6
              << " million cycles a second, preparation included\n";
    EXPECT_EQ(test::difference(loaded.value().view(), config.paper, result), "");
    if (GetParam().published == 0 || std::string(name) != "paper-fpga") continue;
    const double ratio = static_cast<double>(result.cycles) /
                         static_cast<double>(result.triangles) / GetParam().published;
    EXPECT_LT(std::abs(ratio - 1), 0.12) << ratio << " of the published cycles a triangle";
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, PaperScenes,
                         testing::Values(PaperScene{"bunny.ply", 36.7},
                                         PaperScene{"sibenik.ply", 41.3},
                                         PaperScene{"dragon.ply", 29.95},
                                         PaperScene{"sponza.ply", 0},
                                         PaperScene{"buddha_100k.ply", 0}));

}  // namespace
}  // namespace fasttree::model
