// SPDX-License-Identifier: Apache-2.0
#include "model/memory/simple_memory.h"

#include <gtest/gtest.h>

#include "model/memory/make_memory.h"
#include "model/memory/measure.h"

namespace fasttree::model {
namespace {

TEST(SimpleMemory, IdealTakesNoTimeAndAnyNumber) {
  SimpleMemory memory(memory_preset("ideal").value());
  memory.advance(Picoseconds(5));
  for (std::uint32_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(memory.ready(Address(0), false));
    memory.accept({Address(32 * i), 32, false, i}, Picoseconds(5));
  }
  MemoryCompletion completion;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(memory.take(completion));
    EXPECT_EQ(completion.tag, i);
    EXPECT_EQ(completion.at, Picoseconds(5));
  }
  EXPECT_FALSE(memory.take(completion));
  EXPECT_TRUE(memory.idle());
  EXPECT_EQ(memory.statistics().read_bytes, 32000u);
}

TEST(SimpleMemory, FixedLatencyIsExact) {
  MemoryConfig config = memory_preset("fixed").value();
  config.latency_ns = 12.5;
  SimpleMemory memory(config);
  memory.accept({Address(64), 4, false, 9}, Picoseconds(1000));
  MemoryCompletion completion;
  memory.advance(Picoseconds(13499));
  EXPECT_FALSE(memory.take(completion));
  EXPECT_FALSE(memory.idle());
  EXPECT_NE(memory.waits_for(), "");
  memory.advance(Picoseconds(13500));
  ASSERT_TRUE(memory.take(completion));
  EXPECT_EQ(completion.tag, 9u);
  EXPECT_TRUE(memory.idle());
  EXPECT_EQ(memory.waits_for(), "");
}

TEST(SimpleMemory, FixedKeepsItsBandwidthAndItsQueue) {
  MemoryConfig config = memory_preset("fixed").value();
  config.bandwidth_gb_s = 4;
  config.fixed_queue = 128;
  const auto memory = make_memory(config);
  LoadOptions load;
  load.outstanding = 1000;
  load.accesses = 10000;
  const auto measured = measure_memory(*memory, load);
  ASSERT_TRUE(measured.ok());
  EXPECT_NEAR(measured.value().bandwidth_gb_s, 4, 0.01);

  config.fixed_queue = 4;  // four accesses of 32 bytes in 100 ns and the bus's 8
  const auto shallow = make_memory(config);
  EXPECT_NEAR(measure_memory(*shallow, load).value().bandwidth_gb_s, 4 * 32 / 108.0, 0.03);
}

TEST(MeasureMemory, RefusesWhatItCannotDo) {
  const auto memory = make_memory(memory_preset("ideal").value());
  for (void (*wrong)(LoadOptions&) :
       {+[](LoadOptions& o) { o.bytes = 48; }, +[](LoadOptions& o) { o.outstanding = 0; },
        +[](LoadOptions& o) { o.accesses = 0; }, +[](LoadOptions& o) { o.step_ps = 0; },
        +[](LoadOptions& o) { o.span_bytes = 32; }}) {
    LoadOptions load;
    wrong(load);
    EXPECT_EQ(measure_memory(*memory, load).status().code(), StatusCode::invalid_argument);
  }
  LoadOptions load;
  load.accesses = 1000000;
  load.outstanding = 1;
  const auto cancelled = measure_memory(*memory, load, [](double) { return false; });
  EXPECT_EQ(cancelled.status().code(), StatusCode::cancelled);
}

}  // namespace
}  // namespace fasttree::model
