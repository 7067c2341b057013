// SPDX-License-Identifier: Apache-2.0
// The cache in step with the model's: the same answers, traffic, statistics and activity in every
// cycle, under random requests, back-pressure and memory.
#include "model/units/mark_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "Vlru.h"
#include "Vmark_cache.h"
#include "Vmark_cache_pair.h"
#include "Vmark_cache_small.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {
namespace {

using model::Address;
using model::BusRequest;
using model::MarkCache;
using model::MarkRequest;

struct Shape {
  std::uint32_t bytes, ways, miss_penalty;
};

/// What requests and their surroundings are like.
struct Manner {
  unsigned request = 70, answer = 70, serve = 30;  ///< percent a cycle
  unsigned write = 40, hot = 70, same_set = 10;    ///< percent of the requests
  unsigned others = 0;                             ///< percent: the queue to memory is used up
};

/// Memory and the queue of four before it. Every cycle at most one request is served, at random.
struct Memory {
  model::Queue<BusRequest> queue{4};
  std::deque<std::uint64_t> data;
  std::map<std::uint32_t, std::uint64_t> blocks;

  std::uint64_t& block(std::uint32_t address) {
    return blocks.try_emplace(address, address * 0x9e3779b97f4a7c15ull).first->second;
  }
};

template <typename Rtl>
class Lockstep {
 public:
  Lockstep(const Shape& shape, std::uint32_t seed) : bench_(seed), shape_(shape) { forget(); }

  /// A run: `count` requests. Fails at the first difference.
  void run(int count, const Manner& manner) {
    for (; count > 0 || !model_->done() || !memory_.queue.empty();) {
      ASSERT_LT(bench_.cycles(), 20'000'000u);
      if (!wanted_ && count > 0 && bench_.chance(manner.request)) {
        wanted_ = std::make_unique<MarkRequest>(choose(manner));
        --count;
      }
      step(manner);
      if (testing::Test::HasFatalFailure()) return;
    }
    bench_.cycle();  // the statistics come a cycle later
    compare_statistics();
  }

  /// All that is dirty goes to memory, which then holds what was written.
  void flush() {
    bench_.unit.flush = 1;
    bench_.unit.req_valid = 0;
    bench_.cycle();
    bench_.unit.flush = 0;
    while (!bench_.unit.done) {
      bench_.unit.wr_ready = bench_.chance(50);
      bench_.settle();
      ASSERT_FALSE(bench_.unit.rdq_valid);
      if (bench_.unit.wr_valid && bench_.unit.wr_ready) {
        memory_.block(bench_.unit.wr_addr) = bench_.unit.wr_data;
        ++flushed_;
      }
      bench_.cycle();
      bench_.settle();
    }
    for (const auto& [address, word] : words_) {
      ASSERT_EQ(static_cast<std::uint32_t>(memory_.block(address & ~7u) >> (8 * (address & 4u))),
                word)
          << address;
    }
  }

  void forget() {
    config_.mark_cache.bytes = shape_.bytes;
    config_.mark_cache.ways = shape_.ways;
    config_.mark_cache.miss_penalty = shape_.miss_penalty;
    port_ = std::make_unique<model::BusPort>("cache", config_.bus);
    model_ = std::make_unique<MarkCache>(config_, *port_);
    for (auto& [address, block] : memory_.blocks) block += 0x100000001u;  // nobody may remember
    words_.clear();
    bench_.unit.req_valid = 0;
    bench_.unit.flush = 0;
    bench_.unit.rdd_valid = 0;
    bench_.unit.ans_ready = 0;
    bench_.unit.clear = 0;
    await_clear();
    bench_.unit.clear = 1;
    bench_.cycle();
    bench_.unit.clear = 0;
    bench_.settle();
    EXPECT_EQ(await_clear(), shape_.bytes / shape_.ways / 8) << "a set a cycle";
  }

  Bench<Rtl>& bench() { return bench_; }
  std::uint64_t flushed() const { return flushed_; }
  const model::CacheStatistics& statistics() const { return model_->statistics(); }

 private:
  std::uint32_t await_clear() {
    std::uint32_t cycles = 0;
    for (; !bench_.unit.done; ++cycles) {
      bench_.cycle();
      bench_.settle();
    }
    return cycles;
  }

  MarkRequest choose(const Manner& manner) {
    std::uint32_t index = bench_.random() % 4;
    if (bench_.chance(manner.hot)) {
      index = (base_ + bench_.random() % (shape_.bytes / 4)) & 0x3fffffffu;
    } else if (bench_.chance(manner.same_set)) {
      index = bench_.random() % (2 * shape_.ways + 2) * (shape_.bytes / shape_.ways / 4) +
              bench_.random() % 2;
    } else {
      index = bench_.random() & 0x3fffffffu;
    }
    if (bench_.chance(30)) index = last_index_ ^ (bench_.random() & 1);
    if (bench_.chance(1)) base_ = bench_.random();
    last_index_ = index;
    return {Address(std::uint64_t{index} * 4), bench_.chance(manner.write), bench_.random()};
  }

  void step(const Manner& manner) {
    auto& unit = bench_.unit;
    const bool take = bench_.chance(manner.answer);
    const bool serve = bench_.chance(manner.serve);
    unit.req_valid = wanted_ != nullptr;
    if (wanted_) {
      unit.req_addr = static_cast<std::uint32_t>(wanted_->address.value);
      unit.req_write = wanted_->write;
      unit.req_word = wanted_->word;
    }
    // The cache alone never fills the queue.
    if (bench_.chance(manner.others)) {
      while (memory_.queue.ready()) {
        memory_.queue.push({});
        port_->requests.push({});
      }
    }
    unit.ans_ready = take;
    unit.wr_ready = memory_.queue.ready();
    unit.rdd_valid = !memory_.data.empty();
    unit.rdd_data = memory_.data.empty() ? 0 : memory_.data.front();
    bench_.settle();
    unit.rdq_ready = memory_.queue.ready(unit.wr_valid ? 2 : 1);
    bench_.settle();

    ASSERT_EQ(unit.done, model_->done()) << bench_.cycles();
    ASSERT_EQ(unit.req_ready, model_->requests.ready()) << bench_.cycles();
    ASSERT_EQ(unit.ans_valid, model_->answers.valid()) << bench_.cycles();
    if (unit.req_valid && unit.req_ready) {
      if (!wanted_->write) expected_.push_back(word(*wanted_));
      if (wanted_->write) words_[unit.req_addr] = wanted_->word;
      model_->requests.push(*wanted_);
      wanted_.reset();
    }
    if (take && unit.ans_valid) {
      ASSERT_EQ(unit.ans_word, model_->answers.pop()) << bench_.cycles();
      ASSERT_EQ(unit.ans_word, expected_.front()) << bench_.cycles();
      expected_.pop_front();
    }
    if (unit.wr_valid && unit.wr_ready) {
      BusRequest request;
      request.address = Address(unit.wr_addr);
      request.bytes = unit.wr_bytes;
      request.write = true;
      const std::uint64_t data = unit.wr_data;
      std::memcpy(request.data.data(), &data, sizeof data);
      memory_.queue.push(request);
    }
    if (unit.rdq_valid && unit.rdq_ready) {
      BusRequest request;
      request.address = Address(unit.rdq_addr);
      request.bytes = 8;
      memory_.queue.push(request);
    }
    const bool taken = unit.rdd_valid && unit.rdd_ready;
    if (serve) {
      ASSERT_EQ(memory_.queue.valid(), port_->requests.valid()) << bench_.cycles();
    }
    const model::Activity before = model_->activity().back();
    model_->tick();
    ASSERT_EQ(unit.activity, happened(before)) << bench_.cycles();
    if (taken) memory_.data.pop_front();
    if (serve && memory_.queue.valid()) answer();
    model_->clock();
    port_->clock();
    memory_.queue.clock();
    bench_.cycle();
    unit.rdd_valid = 0;
    bench_.settle();
  }

  // What memory does with the request that both have made.
  void answer() {
    const BusRequest mine = memory_.queue.pop();
    const BusRequest other = port_->requests.pop();
    ASSERT_EQ(mine.address.value, other.address.value) << bench_.cycles();
    ASSERT_EQ(mine.write, other.write) << bench_.cycles();
    ASSERT_EQ(mine.bytes, other.bytes) << bench_.cycles();
    if (mine.bytes == 0) return;
    ASSERT_EQ(mine.bytes, 8u);
    std::uint64_t& block = memory_.block(static_cast<std::uint32_t>(mine.address.value));
    if (mine.write) {
      ASSERT_EQ(std::memcmp(mine.data.data(), other.data.data(), 8), 0) << bench_.cycles();
      std::memcpy(&block, mine.data.data(), 8);
    } else {
      memory_.data.push_back(block);
      std::array<std::uint8_t, 8> bytes{};
      std::memcpy(bytes.data(), &block, 8);
      port_->data.push(bytes.data(), 8);
    }
  }

  std::uint32_t word(const MarkRequest& request) {
    const auto address = static_cast<std::uint32_t>(request.address.value);
    const auto found = words_.find(address);
    if (found != words_.end()) return found->second;
    return static_cast<std::uint32_t>(memory_.block(address & ~7u) >> (8 * (address & 4u)));
  }

  unsigned happened(const model::Activity& before) const {
    const model::Activity& after = model_->activity().back();
    if (after.busy_cycles != before.busy_cycles) return 1;
    for (unsigned r = 0; r < after.stalled_cycles.size(); ++r) {
      if (after.stalled_cycles[r] != before.stalled_cycles[r]) return 2 + r;
    }
    return 0;
  }

  void compare_statistics() {
    const model::CacheStatistics& statistics = model_->statistics();
    EXPECT_EQ(bench_.unit.reads, statistics.reads);
    EXPECT_EQ(bench_.unit.read_hits, statistics.read_hits);
    EXPECT_EQ(bench_.unit.writes, statistics.writes);
    EXPECT_EQ(bench_.unit.write_hits, statistics.write_hits);
    EXPECT_EQ(bench_.unit.write_backs, statistics.write_backs);
  }

  Bench<Rtl> bench_;
  Shape shape_;
  model::PaperConfig config_;
  std::unique_ptr<model::BusPort> port_;
  std::unique_ptr<MarkCache> model_;
  Memory memory_;
  std::unique_ptr<MarkRequest> wanted_;
  std::map<std::uint32_t, std::uint32_t> words_;  ///< written in this run
  std::deque<std::uint32_t> expected_;
  std::uint32_t base_ = 0;
  std::uint32_t last_index_ = 0;
  std::uint64_t flushed_ = 0;
};

constexpr Shape kPaper{16384, 16, 2};
constexpr Shape kSmall{256, 4, 5};
constexpr Shape kPair{64, 2, 2};

template <typename Rtl>
void all_manners(const Shape& shape, int requests) {
  Lockstep<Rtl> lockstep(shape, shape.bytes + shape.ways);
  const Manner manners[] = {
      {},
      {.request = 100, .answer = 100, .serve = 100},
      {.request = 100, .answer = 100, .serve = 100, .write = 50, .hot = 99},
      {.request = 100, .answer = 20, .serve = 50, .write = 5},
      {.request = 100, .answer = 100, .serve = 10, .write = 90, .hot = 30},
      {.request = 100, .answer = 90, .serve = 90, .write = 50, .hot = 0, .same_set = 100},
      {.request = 30, .answer = 100, .serve = 100, .write = 0, .hot = 100},
      {.request = 90, .serve = 70, .write = 50, .hot = 40, .others = 20},
  };
  for (const Manner& manner : manners) {
    SCOPED_TRACE(&manner - manners);
    lockstep.run(requests, manner);
    if (testing::Test::HasFatalFailure()) return;
    EXPECT_GT(lockstep.statistics().read_hits, 0u);
    if (&manner - manners == 2) lockstep.flush();
    if (testing::Test::HasFatalFailure()) return;
    // Dirty blocks that are not flushed are lost here, which is what `clear` is for.
    lockstep.forget();
  }
  EXPECT_GT(lockstep.flushed(), 0u);
  EXPECT_EQ(lockstep.bench().failed_assertions(), 0);
}

TEST(RtlMarkCache, IsTheModelCycleForCycle) {
  all_manners<Vmark_cache>(kPaper, 60000);
}
TEST(RtlMarkCache, IsTheModelInOtherShapes) {
  all_manners<Vmark_cache_small>(kSmall, 30000);
  all_manners<Vmark_cache_pair>(kPair, 30000);
}

TEST(RtlMarkCache, FillsEverySetAndFlushesEachDirtyBlockOnce) {
  Lockstep<Vmark_cache> lockstep(kPaper, 5);
  for (int i = 0; i < 3; ++i) {
    lockstep.run(20000, {.request = 100, .answer = 100, .serve = 80, .write = 60, .hot = 100});
    if (testing::Test::HasFatalFailure()) return;
    lockstep.flush();
    const std::uint64_t first = lockstep.flushed();
    lockstep.flush();
    EXPECT_EQ(lockstep.flushed(), first) << "nothing is dirty any more";
    lockstep.forget();
  }
}

TEST(RtlMarkCache, SaysWhenItIsMisused) {
  Bench<Vmark_cache_small> bench;
  bench.unit.req_valid = 0;
  bench.unit.clear = 0;
  bench.unit.flush = 0;
  bench.unit.rdd_valid = 0;
  bench.unit.ans_ready = 0;
  while (!bench.unit.done) bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 0);
  bench.unit.req_valid = 1;
  bench.unit.req_addr = 2;
  bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 1) << "half a word";
  bench.unit.req_valid = 0;
  bench.unit.clear = 1;
  bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 2) << "cleared while it holds a request";
  bench.unit.clear = 0;
  bench.unit.rdd_valid = 1;
  bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 3) << "data for nobody";
}

TEST(RtlLru, KeepsTheOrderOfUse) {
  VerilatedContext context;
  Vlru unit(&context);
  std::vector<int> order;  // the last one used in front
  for (int way = 15; way >= 0; --way) order.push_back(way);
  for (std::size_t i = 0; i < 4; ++i) set_word(unit.order, i, 0);
  std::mt19937 random(3);
  for (int i = 0; i < 200000; ++i) {
    const int way = i % 3 == 0 ? order.back() : static_cast<int>(random() % 16);
    unit.used = static_cast<std::uint16_t>(1u << way);
    unit.eval();
    ASSERT_EQ(unit.oldest, 1u << order.back());
    std::erase(order, way);
    order.insert(order.begin(), way);
    unit.order = unit.updated;
  }
}

}  // namespace
}  // namespace fasttree::rtl
