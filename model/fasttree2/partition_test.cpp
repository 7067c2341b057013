// SPDX-License-Identifier: Apache-2.0
// Records go through memory into buckets and come back in their order; chunks are used again.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

#include "model/fasttree2/chunk_pool.h"
#include "model/fasttree2/dma.h"
#include "model/fasttree2/record_reader.h"
#include "model/fasttree2/test_memory.h"
#include "model/fasttree2/write_combiner.h"

namespace fasttree::model::ft2 {
namespace {

struct Bench {
  Bench(const FastTree2Config& config, const TestMemory::Shape& shape)
      : memory(shape),
        store(8 << 20),
        r(make_registers(config)),
        dma(memory, store, 2000),
        in(2),
        pool(r, dma),
        combiner("write_combiner", r, dma, pool, in, config.buckets, false),
        reader(r, dma, pool, "test") {}

  static Registers make_registers(const FastTree2Config& config) {
    Registers r;
    r.config = config;
    r.triangles = 1 << 20;
    r.layout.chunk_count = (6 << 20) / config.chunk_bytes;
    r.layout.spill = Address(6 << 20);
    r.records = RecordFormat(r.triangles, {4, 4, 4});
    r.chunks = {config.chunk_bytes, config.combine_bytes, r.records.bytes()};
    return r;
  }
  void clock() {
    ++r.cycle;
    dma.tick();
    combiner.tick();
    pool.tick();
    in.clock();
  }

  TestMemory memory;
  ByteStore store;
  Registers r;
  Dma dma;
  Queue<BucketRecord> in;
  ChunkPool pool;
  WriteCombiner combiner;
  RecordReader reader;
};

/// Writes `count` records to random buckets and reads all back; false: something differs.
bool round_trip(Bench& bench, std::uint32_t buckets, std::uint32_t count, std::uint32_t salt) {
  std::vector<std::vector<std::uint32_t>> expected(buckets);
  bench.combiner.begin(buckets);
  std::uint32_t sent = 0;
  std::uint64_t limit = bench.r.cycle + 2'000'000;
  const auto bucket_of = [&](std::uint32_t i) {
    return (i * 2654435761u + salt) >> 16 & (buckets - 1);
  };
  while (!bench.combiner.done() && bench.r.cycle < limit) {
    if (sent < count && bench.in.ready()) {
      bench.in.push({bucket_of(sent), {sent, {{sent & 15, 1, 2}, {3, sent >> 4 & 15, 5}}}});
      expected[bucket_of(sent)].push_back(sent);
      if (++sent == count) bench.combiner.finish();
    }
    bench.clock();
  }
  std::uint32_t started = 0;
  for (std::uint32_t b = 0; b < buckets; ++b) {
    if (bench.combiner.chain(b).count != expected[b].size()) return false;
  }
  for (std::uint32_t b = 0; b < buckets; ++b) {
    for (std::size_t i = 0; i < expected[b].size();) {
      while (started < buckets && bench.reader.can_start()) {
        const BucketChain chain = bench.combiner.chain(started++);
        if (chain.count > 0) bench.reader.start(chain);
      }
      bench.reader.step();
      if (bench.reader.valid()) {
        const Record record = bench.reader.front();
        bench.reader.pop();
        const std::uint32_t id = expected[b][i++];
        if (record.id != id || record.box.lo[0] != (id & 15) ||
            record.box.hi[1] != (id >> 4 & 15)) {
          return false;
        }
      }
      bench.clock();
      if (bench.r.cycle >= limit || !bench.r.failure.empty()) return false;
    }
  }
  return bench.reader.empty();
}

RC_GTEST_PROP(Partition, KeepsTheOrderInEachBucket, ()) {
  FastTree2Config config;
  config.buckets = 1u << *rc::gen::inRange(0, 7);
  config.combine_bytes = 1u << *rc::gen::inRange(4, 8);
  config.chunk_bytes = config.combine_bytes << *rc::gen::inRange(0, 4);
  config.record_prefetch_bytes = 1u << *rc::gen::inRange(6, 11);
  TestMemory::Shape shape;
  shape.access_bytes = 1u << *rc::gen::inRange(3, 8);
  shape.latency_ps = *rc::gen::inRange<std::uint64_t>(0, 200'000);
  Bench bench(config, shape);
  bench.pool.begin(0);
  RC_ASSERT(round_trip(bench, config.buckets, *rc::gen::inRange<std::uint32_t>(1, 2000), 1));
}

TEST(Partition, UsesChunksAgain) {
  FastTree2Config config;
  config.buckets = 16;
  config.combine_bytes = 32;
  config.chunk_bytes = 64;  // many of them: what is free does not fit on the chip
  config.free_chunks = 24;
  Bench bench(config, {});
  bench.pool.begin(0);
  ASSERT_TRUE(round_trip(bench, 16, 3000, 1));
  const std::uint64_t once = bench.pool.most_chunks();
  EXPECT_GT(once, 3000u / 10u);
  for (std::uint32_t i = 0; i < 5; ++i) ASSERT_TRUE(round_trip(bench, 16, 3000, i));
  // A few more, for those are spread differently.
  EXPECT_LE(bench.pool.most_chunks(), once + 2 * 16 + 32);
  EXPECT_GT(bench.dma.write_ports().front()->moved_bytes(), 0u) << "nothing was spilled";
}

TEST(Partition, SaysThatAllChunksAreInUse) {
  FastTree2Config config;
  config.buckets = 16;
  config.chunk_bytes = 256;
  Bench bench(config, {});
  bench.r.layout.chunk_count = 8;
  bench.pool.begin(0);
  EXPECT_FALSE(round_trip(bench, 16, 5000, 1));
  EXPECT_TRUE(bench.pool.exhausted());
}

}  // namespace
}  // namespace fasttree::model::ft2
