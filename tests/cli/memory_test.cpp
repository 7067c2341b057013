// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "runner.h"

namespace fasttree::cli {
namespace {

TEST(CliMemory, MeasuresAPresetAndAConfiguration) {
  const auto preset = run_json({"memory", "--config", "lpddr3-1600", "--pattern", "sequential",
                                "--bytes", "32", "--accesses", "20000"});
  EXPECT_NEAR(preset["bandwidth_gb_s"], 6.23, 0.31);
  EXPECT_GT(preset["latency_ns"], 40);
  EXPECT_EQ(preset["statistics"]["read_bytes"], 640000);
  EXPECT_GT(preset["statistics"]["row_hits"], 19000);

  const auto machine = run_json({"memory", "--config", "paper-asic65", "--pattern", "random",
                                 "--bytes", "64", "--interleave", "row", "--accesses", "20000"});
  EXPECT_EQ(machine["config"], "paper-asic65");
  EXPECT_EQ(machine["memory"]["channels"], 2);
  EXPECT_NEAR(machine["bandwidth_gb_s"], 9.75, 0.49);
}

TEST(CliMemory, WritesHaveNoReadLatency) {
  const auto json = run_json({"memory", "--op", "write", "--accesses", "1000"});
  EXPECT_TRUE(json["latency_ns"].is_null());
  EXPECT_EQ(json["statistics"]["writes"], 2000);
}

TEST(CliMemory, KeysCanBeSet) {
  const auto slow = run_json({"memory", "--config", "fixed", "--outstanding", "1", "--accesses",
                              "100", "--set", "memory.latency_ns=250"});
  EXPECT_EQ(slow["latency_ns"], 250);
  const RunResult wrong = run({"memory", "--set", "memory.cl_clock=9"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("did you mean 'cl_clocks'"), std::string::npos) << wrong.err;
}

TEST(CliMemory, TraceIsWrittenAndChecked) {
  const Folder folder;
  const auto json = run_json({"memory", "--pattern", "mixed", "--accesses", "2000", "--trace",
                              folder.path("trace.txt"), "--check"});
  EXPECT_EQ(json["check"]["violations"], 0);
  const std::string trace = read_file(folder.path("trace.txt"));
  std::size_t lines = 0;
  for (const char c : trace) lines += c == '\n' ? 1 : 0;
  EXPECT_EQ(json["check"]["commands"], lines - 1);
  EXPECT_NE(trace.find(" ACT "), std::string::npos);
}

TEST(CliMemory, RefusesWhatCannotBe) {
  EXPECT_EQ(run({"memory", "--bytes", "48"}).exit_code, 2);
  EXPECT_EQ(run({"memory", "--pattern", "copy", "--op", "write"}).exit_code, 2);
  EXPECT_EQ(run({"memory", "--config", "ideal", "--check"}).exit_code, 2);
  const RunResult unknown = run({"memory", "--config", "paper-asic66"});
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_NE(unknown.err.find("paper-asic65"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace fasttree::cli
