// SPDX-License-Identifier: Apache-2.0
// fasttree compare.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

using nlohmann::json;

const std::vector<std::string> kKinds = {"primary", "shadow", "diffuse"};

bool has_embree() {
  return !run_json({"info"})["embree"].is_null();
}

std::map<std::string, json> by_name(const json& comparison) {
  std::map<std::string, json> builders;
  for (const json& builder : comparison["builders"]) builders[builder["builder"]] = builder;
  return builders;
}

double best_packet_rate(const json& kind) {
  double best = 0;
  for (const auto& [way, figures] : kind["ways"].items()) {
    if (way != "single") best = std::max(best, figures["mrays_per_s"].get<double>());
  }
  return best;
}

TEST(CliCompare, MeasuresTreesAndEmbree) {
  const Folder folder;
  const json all = run_json({"compare", "scene:knot:2000", "--repeat", "2", "--size", "64x64",
                             "--csv", folder.path("c.csv"), "--svg", folder.path("c.svg")});
  EXPECT_EQ(all["same_hits"], true);
  EXPECT_EQ(all["rounds"], 2);
  const auto builders = by_name(all);
  EXPECT_TRUE(builders.contains("realtime"));
  EXPECT_TRUE(builders.contains("paper-cyclic"));
  EXPECT_EQ(builders.contains("embree-low"), has_embree());
  EXPECT_EQ(builders.contains("embree-medium"), has_embree());
  for (const auto& [name, builder] : builders) {
    const bool is_tree = !name.starts_with("embree");
    EXPECT_GT(builder["build_ms"], 0.0) << name;
    EXPECT_EQ(builder["build_ms_all"].size(), 2u) << name;
    for (const std::string& kind : kKinds) {
      const json& figures = builder[kind];
      EXPECT_GT(builder[kind + "_mrays_per_s"], 0.0) << name << kind;
      EXPECT_EQ(figures["mrays_per_s"], builder[kind + "_mrays_per_s"]) << name << kind;
      EXPECT_EQ(figures["ways"][figures["way"]]["mrays_per_s"], figures["mrays_per_s"]);
      const std::vector<std::string> ways =
          is_tree ? std::vector<std::string>{"single", "packet64"}
                  : std::vector<std::string>{"single", "packet8", "packet16"};
      ASSERT_EQ(figures["ways"].size(), ways.size()) << name << kind;
      for (const std::string& way : ways) {
        EXPECT_EQ(figures["ways"][way]["trace_ms_all"].size(), 2u) << name << kind << way;
        EXPECT_LE(figures["ways"][way]["mrays_per_s"], figures["mrays_per_s"]);
      }
    }
    EXPECT_DOUBLE_EQ(builder["frame_ms"], builder["build_ms"].get<double>() +
                                              builder["primary"]["trace_ms"].get<double>() +
                                              builder["shadow"]["trace_ms"].get<double>());
    if (is_tree) {
      EXPECT_GT(builder["primary"]["triangle_tests_per_ray"], 0.0);
      EXPECT_GT(builder["quality"]["nodes"], 0);
    }
  }
  EXPECT_EQ(read_file(folder.path("c.csv")).rfind("builder,", 0), 0u);
  const std::string svg = read_file(folder.path("c.svg"));
  EXPECT_EQ(svg.rfind("<svg", 0), 0u);
  for (const char* part :
       {"realtime", "paper-cyclic", "Build", "primary", "shadow", "diffuse", "Frame"}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
}

TEST(CliCompare, RatiosFollowFromTheFigures) {
  const json all = run_json({"compare", "scene:knot:2000", "--repeat", "1", "--size", "64x64",
                             "--profile", "sah-binned"});
  const json& ratio = all["ratio"];
  EXPECT_EQ(ratio["of"], "sah-binned");
  if (!has_embree()) {
    EXPECT_EQ(all["builders"].size(), 1u);
    for (const auto& [key, value] : ratio.items()) {
      if (value.is_number()) ADD_FAILURE() << key << " needs Embree";
    }
    return;
  }
  const auto builders = by_name(all);
  ASSERT_EQ(builders.size(), 3u);
  const json& tree = builders.at("sah-binned");
  const json& low = builders.at("embree-low");
  const json& medium = builders.at("embree-medium");
  const auto number = [](const json& value) { return value.get<double>(); };
  EXPECT_DOUBLE_EQ(ratio["build"], std::min(number(low["build_ms"]), number(medium["build_ms"])) /
                                       number(tree["rated_build_ms"]));
  // A tree that can be walked as it is: without the tracer's layout, which its frames have.
  EXPECT_NEAR(number(tree["rated_build_ms"]) + number(tree["layout_ms"]), number(tree["build_ms"]),
              1e-6);
  EXPECT_EQ(low["rated_build_ms"], low["build_ms"]);
  EXPECT_DOUBLE_EQ(ratio["frame"], std::min(number(low["frame_ms"]), number(medium["frame_ms"])) /
                                       number(tree["frame_ms"]));
  for (const std::string& kind : kKinds) {
    const auto single = [&](const json& b) {
      return number(b[kind]["ways"]["single"]["mrays_per_s"]);
    };
    EXPECT_DOUBLE_EQ(ratio[kind + "_single"], single(tree) / single(medium));
    EXPECT_DOUBLE_EQ(ratio["low"][kind + "_single"], single(tree) / single(low));
    EXPECT_DOUBLE_EQ(ratio[kind + "_packet"],
                     best_packet_rate(tree[kind]) / best_packet_rate(medium[kind]));
    EXPECT_EQ(ratio["medium"][kind + "_packet"], ratio[kind + "_packet"]);
  }
}

TEST(CliCompare, EmbreeSeesTheSameScene) {
  if (!has_embree()) GTEST_SKIP() << "built without Embree";
  // Sizes that leave tiles and packets unfilled.
  for (const char* size : {"64x64", "61x35", "3x5", "1x1"}) {
    const json all = run_json({"compare", "scene:hall:5000", "--repeat", "1", "--size", size,
                               "--builders", "embree,sah-binned"});
    for (const auto& [name, builder] : by_name(all)) {
      if (name == "sah-binned") continue;
      for (const std::string& kind : kKinds) {
        const double rays = builder[kind]["rays"];
        EXPECT_LE(builder[kind]["other_outcomes"].get<double>(), std::ceil(0.005 * rays))
            << name << kind << size;
      }
    }
  }
}

TEST(CliCompare, TracesOneRayAPixelAndTheOthersFromTheHits) {
  const json all = run_json({"compare", "scene:hall:5000", "--repeat", "1", "--size", "61x35",
                             "--builders", "paper-longest"});
  const json& builder = all["builders"][0];
  EXPECT_EQ(builder["primary"]["rays"], 61 * 35);
  EXPECT_GT(builder["shadow"]["rays"], 61 * 35 / 2);  // a closed room
  EXPECT_EQ(builder["shadow"]["rays"], builder["diffuse"]["rays"]);
  EXPECT_EQ(all["same_hits"], true);  // single rays and packets of border tiles
}

TEST(CliCompare, LooksWhereItIsTold) {
  const auto look = [](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"compare", "scene:knot:500", "--repeat",    "1", "--size",
                                          "16x16",   "--builders",     "paper-cyclic"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_json(arguments);
  };
  const json plain = look({});
  EXPECT_EQ(look({"--view", "outside"})["camera"], plain["camera"]);
  const json tight = look({"--view", "tight"});
  EXPECT_NE(tight["camera"], plain["camera"]);
  EXPECT_GT(tight["builders"][0]["shadow"]["rays"], plain["builders"][0]["shadow"]["rays"]);
  const json placed = look({"--eye", "0,0,9", "--target", "0,1,0", "--light", "1,2,3"});
  EXPECT_EQ(placed["camera"]["eye"], json({0.0, 0.0, 9.0}));
  EXPECT_EQ(placed["light"], json({1.0, 2.0, 3.0}));
}

TEST(CliCompare, MeasuresTheBuildersAskedFor) {
  const json all = run_json({"compare", "scene:knot:500", "--repeat", "1", "--size", "16x16",
                             "--builders", "sah-exact,paper-longest,sah-exact"});
  ASSERT_EQ(all["builders"].size(), 2u);
  EXPECT_EQ(all["builders"][0]["builder"], "sah-exact");
  EXPECT_EQ(all["ratio"]["of"], "sah-exact");
  EXPECT_TRUE(all["ratio"]["build"].is_null());
  EXPECT_TRUE(all["ratio"]["low"]["frame"].is_null());
}

TEST(CliCompare, SaysWhyThereAreNoRatios) {
  const RunResult result = run(
      {"compare", "scene:knot:500", "--repeat", "1", "--size", "16x16", "--builders", "realtime"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("no ratios: "), std::string::npos) << result.out;
}

TEST(CliCompare, NeedsATree) {
  const RunResult result = run({"compare", "scene:knot:500", "--builders", "embree-low"});
  EXPECT_EQ(result.exit_code, 2);
}

TEST(CliCompare, GoesWithoutEmbreeWhereCoordinatesAreTooLarge) {
  const Folder folder;
  const std::string path = folder.path("far.obj");
  write_file(path, "v 0 0 0\nv 4e18 0 0\nv 0 4e18 1e18\nf 1 2 3\n");
  const RunResult result = run({"compare", path, "--repeat", "1", "--size", "8x8"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("no ratios: "), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("embree-low"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace fasttree::cli
