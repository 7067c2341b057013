// SPDX-License-Identifier: Apache-2.0
#include "model/units/mark_cache.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <list>

#include "model/units/unit_bench.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

/// What a cache is by definition: a list of blocks a set, the one used last in front.
class SimpleCache {
 public:
  explicit SimpleCache(const PaperConfig::MarkCache& config)
      : config_(config), sets_(config.bytes / (config.ways * config.block_bytes)) {}

  bool access(std::uint64_t address) {
    const std::uint64_t number = address / config_.block_bytes;
    std::list<std::uint64_t>& set = sets_[number % sets_.size()];
    const auto found = std::find(set.begin(), set.end(), number);
    const bool hit = found != set.end();
    if (hit) set.erase(found);
    set.push_front(number);
    if (set.size() > config_.ways) set.pop_back();
    return hit;
  }

 private:
  PaperConfig::MarkCache config_;
  std::vector<std::list<std::uint64_t>> sets_;
};

struct Outcome {
  CacheStatistics statistics;
  CacheStatistics expected;
  std::uint64_t cycles = 0;
  bool words_right = true;
};

// Random reads and writes in a window that moves, so that blocks are used again and evicted.
Outcome run(const PaperConfig& config, bool broken, std::uint64_t seed) {
  test::UnitBench bench(config);
  MarkCache cache(config, bench.bus.add_port("cache"));
  if (broken) cache.break_replacement();
  SimpleCache simple(config.mark_cache);
  fasttree::test::Random random(seed);
  std::vector<std::uint32_t> words(1 << 14);
  for (std::uint32_t& word : words) word = random.below(~0u);
  bench.put(Address(0), words);
  Clocks clocks;
  clocks.add(cache);
  Outcome result;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const std::uint32_t index =
        random.below(4) == 0 ? random.below(1 << 14) : (i * 2 + random.below(1500)) % (1 << 14);
    const bool write = random.below(3) == 0;
    const bool hit = simple.access(index * 4);
    ++(write ? result.expected.writes : result.expected.reads);
    if (hit) ++(write ? result.expected.write_hits : result.expected.read_hits);
    const std::uint32_t word = random.below(~0u);
    cache.requests.push({Address(index * 4), write, word});
    while (!cache.requests.empty() || !cache.done()) {
      if (cache.answers.valid() && cache.answers.pop() != words[index]) result.words_right = false;
      bench.step({&cache}, clocks);
      ++result.cycles;
    }
    if (write) words[index] = word;
  }
  while (!bench.bus.done()) bench.step({&cache}, clocks);
  std::vector<std::uint8_t> bytes(words.size() * 4);
  bench.store.read(Address(0), bytes.data(), bytes.size());
  cache.copy_dirty(Address(0), bytes);
  if (std::memcmp(bytes.data(), words.data(), bytes.size()) != 0) result.words_right = false;
  result.statistics = cache.statistics();
  return result;
}

bool same(const CacheStatistics& a, const CacheStatistics& b) {
  return a.reads == b.reads && a.read_hits == b.read_hits && a.writes == b.writes &&
         a.write_hits == b.write_hits;
}

RC_GTEST_PROP(MarkCache, HitsWhatALeastRecentlyUsedListHits, ()) {
  PaperConfig config;
  config.mark_cache.ways = 1u << *rc::gen::inRange(0, 5);
  config.mark_cache.block_bytes = 4u << *rc::gen::inRange(0, 5);
  config.mark_cache.bytes = config.mark_cache.ways * config.mark_cache.block_bytes
                            << *rc::gen::inRange(0, 6);
  config.mark_cache.write_back = *rc::gen::arbitrary<bool>();
  const Outcome result = run(config, false, *rc::gen::inRange(1, 1000));
  RC_ASSERT(result.words_right);
  RC_ASSERT(same(result.statistics, result.expected));
}

/// The bytes stay right, since what is evicted is written back; the hits tell.
TEST(MarkCache, AWrongVictimShowsInTheHits) {
  PaperConfig config;
  config.mark_cache.bytes = 2048;
  EXPECT_TRUE(same(run(config, false, 7).statistics, run(config, false, 7).expected));
  const Outcome broken = run(config, true, 7);
  EXPECT_TRUE(broken.words_right);
  EXPECT_FALSE(same(broken.statistics, broken.expected));
  EXPECT_LT(broken.statistics.read_hits, broken.expected.read_hits);
}

TEST(MarkCache, AnswersAHitInItsLatencyAndBlocksOnAMiss) {
  for (const std::uint32_t latency : {1u, 3u}) {
    PaperConfig config;
    config.mark_cache.hit_latency = latency;
    test::UnitBench bench(config);
    bench.put(Address(0), {11, 22});
    MarkCache cache(config, bench.bus.add_port("cache"));
    Clocks clocks;
    clocks.add(cache);
    const auto cycles_of = [&](std::uint64_t address, std::uint32_t expected) {
      cache.requests.push({Address(address), false, 0});
      clocks.clock();
      std::uint32_t cycles = 0;
      while (!cache.answers.valid()) {
        bench.step({&cache}, clocks);
        ++cycles;
      }
      EXPECT_EQ(cache.answers.pop(), expected);
      clocks.clock();
      return cycles;
    };
    EXPECT_GT(cycles_of(0, 11), 10u) << "the memory takes 10 cycles";
    EXPECT_EQ(cycles_of(4, 22), latency) << "of the same block";
  }
}

}  // namespace
}  // namespace fasttree::model
