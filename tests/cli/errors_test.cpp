// SPDX-License-Identifier: Apache-2.0
// Wrong usage, bad input, full disks, closed pipes, Ctrl-C: the right exit code and a message that
// says what to do.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "runner.h"

namespace fasttree::cli {
namespace {

void expect_error(const RunResult& result, int exit_code, const std::string& part) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(result.err.rfind("fasttree: error: ", 0), 0u) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err << "lacks: " << part;
}

TEST(CliErrors, WrongUsageIsAnsweredWithTheRightOne) {
  struct Case {
    std::vector<std::string> arguments;
    const char* part;
  };
  const std::vector<Case> cases = {
      {{"bild"}, "did you mean build"},
      {{"build", "scene:knot:100", "--axis", "longest"}, "did you mean --axes"},
      {{"build", "scene:knot:100", "--axis=longest"}, "did you mean --axes"},
      {{"build", "scene:knot:100", "--axes", "longst"}, "did you mean longest"},
      {{"build", "scene:knot:100", "--profile", "quick"}, "paper, sah-exact, sah-binned"},
      {{"build", "scene:knot:100", "--depth", "31"}, "0 to 30"},
      {{"build", "scene:knot:100", "--depth", "-1"}, "0 to 30"},
      {{"build", "scene:knot:100", "--repeat", "0"}, "1 to"},
      {{"build", "scene:knot:100", "--repeat", "3x"}, "whole number"},
      {{"build", "scene:knot:100", "--memory-limit", "lots"}, "512M"},
      {{"build", "scene:knot:100", "--threads", "many"}, "whole number"},
      {{"build", "scene:knot:100", "--json"}, "--json"},
      {{"build"}, "SCENE is required"},
      {{"build", "scene:knot:100", "extra"}, "extra"},
      {{"build", "scene:knot:100", "--out", ""}, "--out"},
      {{"render", "scene:knot:100"}, "--out"},
      {{"render", "scene:knot:100", "--out", "x.png", "--eye", "1,2"}, "three numbers"},
      {{"render", "scene:knot:100", "--out", "x.png", "--eye", "1,2,nan"}, "three numbers"},
      {{"render", "scene:knot:100", "--out", "x.png", "--size", "0x4"}, "800x600"},
      {{"render", "scene:knot:100", "--out", "x.png", "--fov", "180"}, "179"},
      {{"render", "scene:knot:100", "--out", "x.png", "--flat", "--smooth"}, "--smooth"},
      {{"compare", "scene:knot:100", "--builders", "paper-cyclical"}, "did you mean paper-cyclic"},
      {{"compare", "scene:knot:100", "--builders", "realtime,embree-lo"},
       "did you mean embree-low"},
      {{"compare", "scene:knot:100", "--profile", "realtme"}, "did you mean realtime"},
      {{"compare", "scene:knot:100", "--profile", "paper", "--builders", "realtime"}, "not both"},
      {{"compare", "scene:knot:100", "--light", "1,2"}, "three numbers"},
      {{"verify", "scene:knot:100", "--mesh", "scene:knot:100"}, "tree file"},
      {{"build", "scene:knto:100"}, "knot"},
  };
  for (const Case& c : cases) expect_error(run(c.arguments), 2, c.part);
}

TEST(CliErrors, NoSubcommandShowsTheHelp) {
  const RunResult result = run({});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("compare"), std::string::npos);
}

TEST(CliErrors, BadInputIsThree) {
  const Folder folder;
  expect_error(run({"build", folder.path("nothing.ply")}), 3, "nothing.ply");
  write_file(folder.path("short.ply"), "ply\nformat ascii 1.0\nelement vertex 3\n");
  expect_error(run({"build", folder.path("short.ply")}), 3, "short.ply");
  write_file(folder.path("index.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  expect_error(run({"build", folder.path("index.obj")}), 3, "index.obj");
  expect_error(run({"build", "/"}), 3, "/");
  write_file(folder.path("nan.ply"),
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n");
  EXPECT_EQ(run({"build", folder.path("nan.ply")}).exit_code, 3);
}

TEST(CliErrors, UnwritablePlacesAreThree) {
  const Folder folder;
  const std::string nowhere = folder.path("no/such/folder/file");
  expect_error(run({"build", "scene:knot:500", "--out", nowhere}), 3, nowhere);
  expect_error(run({"build", "scene:knot:500", "--json", nowhere}), 3, nowhere);
  expect_error(run({"render", "scene:knot:500", "--size", "8x8", "--out", nowhere}), 3, nowhere);
}

TEST(CliErrors, MemoryLimitIsFour) {
  expect_error(run({"build", "scene:knot:20000", "--memory-limit", "64K"}), 4, "");
  expect_error(run({"build", "scene:knot:20000", "--profile", "paper", "--depth", "27",
                    "--memory-limit", "40M"}),
               4, "");
}

TEST(CliErrors, AFullDiskIsFourAndLeavesNothing) {
  const Folder folder;
  RunSettings full;
  full.prepare = [] {
    const rlimit limit{4096, 4096};
    setrlimit(RLIMIT_FSIZE, &limit);
  };
  const std::string tree = folder.path("t.ft");
  expect_error(run({"build", "scene:knot:20000", "--out", tree}, full), 4, tree);
  const std::string picture = folder.path("p.png");
  expect_error(run({"render", "scene:knot:2000", "--out", picture}, full), 4, picture);
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(CliErrors, AFullDiskLeavesTheOldFile) {
  const Folder folder;
  const std::string tree = folder.path("t.ft");
  write_file(tree, "old");
  RunSettings full;
  full.prepare = [] {
    const rlimit limit{4096, 4096};
    setrlimit(RLIMIT_FSIZE, &limit);
  };
  EXPECT_EQ(run({"build", "scene:knot:20000", "--out", tree}, full).exit_code, 4);
  EXPECT_EQ(read_file(tree), "old");
}

TEST(CliErrors, StandardOutputThatCannotBeWritten) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  RunSettings full;
  full.stdout_path = "/dev/full";
  expect_error(run({"info"}, full), 4, "standard output");
  expect_error(run({"info", "--help"}, full), 4, "standard output");
  RunSettings closed;
  closed.prepare = [] {
    // A pipe whose reader is gone.
    int ends[2];
    if (pipe(ends) != 0) _exit(125);
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
  };
  expect_error(run({"info"}, closed), 3, "standard output");
}

TEST(CliErrors, ControlCIsOneHundredAndThirty) {
  RunSettings interrupt;
  interrupt.meanwhile = [](int pid) { kill(pid, SIGINT); };
  const Folder folder;
  const RunResult result = run({"verify", "scene:cloud:50000", "--oracle", "brute", "--rays",
                                "1000000000", "--json", folder.path("v.json")},
                               interrupt);
  expect_error(result, 130, "cancelled");
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
}  // namespace fasttree::cli
