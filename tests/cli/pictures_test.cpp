// SPDX-License-Identifier: Apache-2.0
// fasttree render.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

TEST(CliRender, DrawsEveryMode) {
  const Folder folder;
  for (const char* mode : {"shaded", "heat", "leaves"}) {
    const std::string picture = folder.path(std::string(mode) + ".png");
    const auto json = run_json(
        {"render", "scene:knot:2000", "--mode", mode, "--size", "320x240", "--out", picture});
    EXPECT_EQ(json["width"], 320);
    EXPECT_EQ(json["mode"], mode);
    EXPECT_EQ(read_file(picture).substr(1, 3), "PNG") << mode;
  }
  EXPECT_NE(read_file(folder.path("shaded.png")), read_file(folder.path("heat.png")));
  EXPECT_NE(read_file(folder.path("leaves.png")), read_file(folder.path("heat.png")));
}

TEST(CliRender, OptionsChangeThePicture) {
  const Folder folder;
  const auto draw = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {
        "render", "scene:knot:2000", "--size", "64x64", "--quiet", "--out", folder.path("p.png")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_file(folder.path("p.png"));
  };
  const std::string plain = draw({});
  EXPECT_EQ(draw({"--threads", "1"}), plain);
  EXPECT_EQ(draw({"--smooth", "--shadows"}), plain);
  EXPECT_EQ(draw({"--profile", "sah-binned"}), plain);
  EXPECT_NE(draw({"--flat"}), plain);
  EXPECT_NE(draw({"--no-shadows"}), plain);
  EXPECT_NE(draw({"--ao", "8"}), plain);
  EXPECT_NE(draw({"--view", "outside"}), plain);
  EXPECT_NE(draw({"--view", "tight", "--fov", "30"}), plain);
  EXPECT_NE(draw({"--eye", "-3,4,5.5"}), plain);
}

TEST(CliRender, DrawsFromATreeFile) {
  const Folder folder;
  const std::string tree = folder.path("t.ft");
  ASSERT_EQ(run({"build", "scene:knot:2000", "--out", tree}).exit_code, 0);
  const auto draw = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--size", "64x64", "--out", folder.path("p.png")});
    const RunResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_file(folder.path("p.png"));
  };
  EXPECT_EQ(draw({"render", tree, "--mesh", "scene:knot:2000"}),
            draw({"render", "scene:knot:2000"}));
  EXPECT_EQ(
      run({"render", tree, "--mesh", "scene:knot:3000", "--out", folder.path("q.png")}).exit_code,
      3);
}

}  // namespace
}  // namespace fasttree::cli
