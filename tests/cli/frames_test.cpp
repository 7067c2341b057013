// SPDX-License-Identifier: Apache-2.0
// fasttree animate and fasttree view.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

void expect_error(const RunResult& result, int exit_code, const std::string& part) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(result.err.rfind("fasttree: error: ", 0), 0u) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err << "lacks: " << part;
}

std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// Of a PNG's first chunk, big-endian.
std::uint32_t png_number(const std::string& png, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = at; i < at + 4; ++i) {
    number = number << 8 | static_cast<unsigned char>(png[i]);
  }
  return number;
}

void expect_png(const std::string& path, std::uint32_t width, std::uint32_t height) {
  const std::string png = read_file(path);
  ASSERT_GE(png.size(), 24u) << path;
  EXPECT_EQ(png.substr(1, 3), "PNG") << path;
  EXPECT_EQ(png_number(png, 16), width) << path;
  EXPECT_EQ(png_number(png, 20), height) << path;
}

TEST(CliAnimate, CountsTheFramesOfAScene) {
  const auto json = run_json({"animate", "scene:breakup:300", "--size", "32x24", "--loops", "2"});
  EXPECT_EQ(json["frame_count"], 24);
  EXPECT_EQ(json["loops"], 2);
  EXPECT_EQ(json["profile"], "realtime");
  EXPECT_EQ(json["width"], 32);
  EXPECT_EQ(json["height"], 24);
  EXPECT_GT(json["first_build_ms"], 0);
  ASSERT_EQ(json["frames"].size(), 24u);
  for (std::size_t f = 0; f < 24; ++f) {
    const auto& frame = json["frames"][f];
    EXPECT_EQ(frame["frame"], f);
    EXPECT_EQ(frame["name"], "scene:breakup:300:" + std::to_string(f));
    EXPECT_GT(frame["triangles"], 0);
    for (const char* key : {"build_ms", "tree_ms", "layout_ms", "trace_ms", "primary_ms",
                            "shadow_ms", "frame_ms", "fps"}) {
      ASSERT_TRUE(frame[key].is_number()) << key;
      EXPECT_GE(frame[key], 0) << key;
    }
    EXPECT_FALSE(frame["stages_ms"].empty());
    EXPECT_EQ(frame["primary_rays"], 32 * 24);
    EXPECT_LE(frame["shadow_rays"], frame["hits"]);
    EXPECT_LE(frame["lit"], frame["shadow_rays"]);
  }
  EXPECT_GT(json["frames"][0]["hits"], 0);
  for (const char* which : {"median", "worst"}) {
    for (const char* key : {"build_ms", "trace_ms", "frame_ms", "fps"}) {
      EXPECT_GT(json[which][key], 0) << which << ' ' << key;
    }
  }
  EXPECT_LE(json["median"]["frame_ms"], json["worst"]["frame_ms"]);
}

TEST(CliAnimate, HitsTheSameForAnyNumberOfThreadsAndProfile) {
  const auto hits = [](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"animate", "scene:wave:500", "--size",
                                          "32x32",   "--frames",       "3"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    std::vector<std::uint64_t> counts;
    const auto json = run_json(arguments);
    for (const auto& frame : json["frames"]) {
      counts.push_back(frame["hits"]);
      counts.push_back(frame["lit"]);
    }
    EXPECT_EQ(counts.size(), 6u);
    return counts;
  };
  const auto counts = hits({});
  EXPECT_EQ(hits({"--threads", "1"}), counts);
  EXPECT_EQ(hits({"--profile", "paper"}), counts);
}

TEST(CliAnimate, TakesAFolderAndWritesItsFiles) {
  const Folder folder;
  const std::string frames = folder.path("frames");
  std::filesystem::create_directory(frames);
  for (const char* name : {"10.obj", "9.obj", "2.obj"}) write_file(frames + "/" + name, kTriangle);
  write_file(frames + "/notes.txt", "no frame");
  const std::string csv = folder.path("f.csv"), svg = folder.path("f.svg"),
                    pictures = folder.path("out/pictures");
  const auto json = run_json(
      {"animate", frames, "--size", "40x30", "--csv", csv, "--svg", svg, "--out-dir", pictures});
  EXPECT_EQ(json["scene"], "frames");
  ASSERT_EQ(json["frame_count"], 3);
  EXPECT_EQ(json["frames"][0]["name"], "2.obj");
  EXPECT_EQ(json["frames"][2]["name"], "10.obj");

  const std::string table = read_file(csv);
  EXPECT_EQ(table.rfind("frame,name,triangles,build_ms,", 0), 0u) << table;
  EXPECT_EQ(line_count(table), 4u) << table;
  EXPECT_NE(table.find("\n1,9.obj,1,"), std::string::npos) << table;

  const std::string plot = read_file(svg);
  EXPECT_EQ(plot.rfind("<svg", 0), 0u);
  EXPECT_NE(plot.find("milliseconds"), std::string::npos);
  EXPECT_NE(plot.find("<polyline"), std::string::npos);
  EXPECT_EQ(plot.find("nan"), std::string::npos);

  for (const char* name : {"/frame_0000.png", "/frame_0001.png", "/frame_0002.png"}) {
    expect_png(pictures + name, 40, 30);
  }
  EXPECT_FALSE(std::filesystem::exists(pictures + "/frame_0003.png"));
}

TEST(CliAnimate, SaysATableOrNothing) {
  const RunResult result = run({"animate", "scene:wave:500", "--frames", "2", "--size", "16x16"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out.rfind("frame ", 0), 0u) << result.out;
  EXPECT_NE(result.out.find("\nmedian "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\nslowest  scene:wave:500:"), std::string::npos) << result.out;
  const RunResult quiet =
      run({"animate", "scene:wave:500", "--frames", "2", "--size", "16x16", "--quiet"});
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST(CliAnimate, SaysWhatIsWrong) {
  const Folder folder;
  const std::string frames = folder.path("frames");
  std::filesystem::create_directory(frames);
  expect_error(run({"animate", frames}), 3, "is empty");
  write_file(frames + "/notes.txt", "");
  expect_error(run({"animate", frames}), 3, "no mesh file");
  write_file(frames + "/000.obj", kTriangle);
  write_file(frames + "/001.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  expect_error(run({"animate", frames}), 3, "001.obj");
  expect_error(run({"animate", folder.path("none.ply")}), 3, "none.ply");

  expect_error(run({"animate", "scene:knot:100"}), 2, "these do: scene:wave, scene:breakup");
  expect_error(run({"animate", "scene:wave:500:3"}), 2, "leave the frame's number out");
  expect_error(run({"animate", frames + "/000.obj"}), 2, "fasttree view");
  expect_error(run({"animate", "scene:wave:500", "--frames", "25"}), 2, "--loops");
  write_file(folder.path("file"), "");
  expect_error(
      run({"animate", "scene:wave:500", "--frames", "1", "--out-dir", folder.path("file/x")}), 3,
      "--out-dir");
}

/// A program built without SDL says so before it reads anything.
class CliView : public testing::Test {
 protected:
  void SetUp() override {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    const RunResult result = run({"view", "scene:knot:100", "--size", "16x16", "--frames", "1"});
    if (result.err.find("built without a window") != std::string::npos) {
      EXPECT_EQ(result.exit_code, 2);
      GTEST_SKIP() << "the program was built without SDL2 (Debian's libsdl2-dev)";
    }
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  void TearDown() override { unsetenv("SDL_VIDEODRIVER"); }
};

TEST_F(CliView, ShowsFramesAndWritesTheLast) {
  const Folder folder;
  const std::string picture = folder.path("view.png");
  const auto json = run_json({"view", "scene:breakup:300", "--size", "200x120", "--frames", "3",
                              "--max-fps", "0", "--screenshot", picture});
  EXPECT_EQ(json["frames"], 3);
  EXPECT_EQ(json["frames_of_source"], 24);
  EXPECT_EQ(json["width"], 200);
  EXPECT_EQ(json["height"], 120);
  EXPECT_EQ(json["heat"], false);
  for (const char* key : {"build_ms", "tree_ms", "layout_ms", "trace_ms", "primary_ms", "shade_ms",
                          "show_ms", "frame_ms", "worst_frame_ms", "fps", "first_build_ms"}) {
    ASSERT_TRUE(json[key].is_number()) << key;
    EXPECT_GT(json[key], 0) << key;
  }
  EXPECT_LE(json["frame_ms"], json["worst_frame_ms"]);
  EXPECT_FALSE(json["stages_ms"].empty());
  expect_png(picture, 200, 120);
}

TEST_F(CliView, RebuildsAStillSceneAndShowsItsCost) {
  const Folder folder;
  const std::string plain = folder.path("plain.png"), heat = folder.path("heat.png");
  const std::vector<std::string> arguments = {
      "view", "scene:knot:500", "--size", "64x48", "--frames", "2", "--screenshot"};
  auto shaded = arguments, heated = arguments;
  shaded.push_back(plain);
  heated.insert(heated.end(), {heat, "--heat"});
  EXPECT_EQ(run_json(shaded)["frames_of_source"], 1);
  EXPECT_EQ(run_json(heated)["heat"], true);
  expect_png(plain, 64, 48);
  expect_png(heat, 64, 48);
  EXPECT_NE(read_file(plain), read_file(heat));
}

TEST_F(CliView, SaysWhatIsWrong) {
  const Folder folder;
  expect_error(run({"view", folder.path("none.ply"), "--frames", "1"}), 3, "none.ply");
  expect_error(run({"view", folder.path(""), "--frames", "1"}), 3, "is empty");
  setenv("SDL_VIDEODRIVER", "none-such", 1);
  expect_error(run({"view", "scene:knot:100", "--frames", "1"}), 2, "SDL_VIDEODRIVER=dummy");
}

}  // namespace
}  // namespace fasttree::cli
