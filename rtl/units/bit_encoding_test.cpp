// SPDX-License-Identifier: Apache-2.0
// The BEU in step with the model's, and its words against the reference.
#include "model/units/bit_encoding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <set>
#include <vector>

#include "Vbit_encoding.h"
#include "reference/bit_encoding.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {
namespace {

using model::Address;
using model::BusRequest;
using model::MarkRequest;

constexpr std::uint32_t kMarks = 0x12345000;

class Lockstep {
 public:
  explicit Lockstep(std::uint32_t seed) : bench_(seed) {
    auto& unit = bench_.unit;
    unit.start_clear = unit.start_marks = unit.mark_valid = unit.wr_ready = unit.req_ready = 0;
    unit.marks = kMarks;
    bench_.reset();
    EXPECT_EQ(unit.done, 1);
  }

  /// Zeros over so many bytes; the bytes around them stay.
  void clear(std::uint32_t bytes, unsigned serve) {
    std::vector<std::uint32_t> words(bytes / 4 + 32, 0xa5a5a5a5u);
    bench_.unit.mark_bytes = bytes;
    bench_.unit.start_clear = 1;
    bench_.cycle();
    bench_.unit.start_clear = 0;
    beu_.start_clear(Address(kMarks), bytes);
    std::uint64_t cycles = 0;
    for (; !beu_.done(); ++cycles) {
      step(false, serve, 50);
      if (testing::Test::HasFatalFailure()) return;
    }
    ASSERT_EQ(bench_.unit.done, 1);
    if (serve == 100) {
      EXPECT_EQ(cycles, (bytes + 63) / 64);
    }
    while (!writes_.empty() && !testing::Test::HasFatalFailure()) step(false, 100, 50);
    for (const auto& [address, count] : written_) {
      ASSERT_GE(address, kMarks);
      for (std::uint32_t b = 0; b < count; b += 4) words.at((address - kMarks + b) / 4) = 0;
    }
    written_.clear();
    std::vector<std::uint32_t> expected(bytes / 4, 0);
    expected.resize(words.size(), 0xa5a5a5a5u);
    EXPECT_EQ(words, expected);
  }

  /// The words that go to the cache, as the reference has them.
  void mark(const std::set<std::uint32_t>& nodes, int depth, unsigned send, unsigned take) {
    const auto count = static_cast<std::uint32_t>(nodes.size());
    bench_.unit.nodes = count;
    bench_.unit.start_marks = 1;
    bench_.cycle();
    bench_.unit.start_marks = 0;
    beu_.start_marks(Address(kMarks), count);
    nodes_.assign(nodes.begin(), nodes.end());
    std::uint64_t cycles = 0;
    for (; !beu_.done(); ++cycles) {
      step(bench_.chance(send), 50, take);
      if (testing::Test::HasFatalFailure()) return;
    }
    ASSERT_EQ(bench_.unit.done, 1);
    while (!words_.empty() && !testing::Test::HasFatalFailure()) step(false, 50, 100);
    if (send == 100 && take == 100) {
      EXPECT_LE(cycles, count + 2) << "a node a cycle";
    }
    reference::InternalNodes internal;
    internal.node_index.assign(nodes.begin(), nodes.end());
    std::vector<std::uint32_t> words(reference::bit_encoding(internal, depth).words().size());
    for (const auto& [address, word] : marked_) {
      ASSERT_EQ(words.at((address - kMarks) / 4), 0u) << "written once";
      words.at((address - kMarks) / 4) = word;
    }
    marked_.clear();
    EXPECT_EQ(words, reference::bit_encoding(internal, depth).words());
  }

  Bench<Vbit_encoding>& bench() { return bench_; }

 private:
  // `serve`, `take`: how often bus and cache take something, in percent.
  void step(bool send, unsigned serve, unsigned take) {
    auto& unit = bench_.unit;
    // What has been offered stays.
    offered_ = !nodes_.empty() && (offered_ || send);
    unit.mark_valid = offered_;
    unit.mark_index = offered_ ? nodes_.front() : bench_.random();
    unit.wr_ready = writes_.ready();
    unit.req_ready = words_.ready();
    bench_.settle();
    ASSERT_EQ(unit.mark_ready, beu_.input.ready()) << bench_.cycles();
    ASSERT_EQ(unit.done, beu_.done()) << bench_.cycles();
    if (offered_ && unit.mark_ready) {
      beu_.input.push(nodes_.front());
      nodes_.pop_front();
      offered_ = false;
    }
    const model::Activity before = beu_.activity().back();
    beu_.tick();
    const model::Activity& after = beu_.activity().back();
    const unsigned activity = after.busy_cycles != before.busy_cycles               ? 1
                              : after.idle_cycles != before.idle_cycles             ? 0
                              : after.stalled_cycles[0] != before.stalled_cycles[0] ? 2
                                                                                    : 3;
    ASSERT_EQ(unit.activity, activity) << bench_.cycles();
    if (unit.wr_valid && unit.wr_ready) {
      writes_.push({unit.wr_addr, unit.wr_bytes});
      for (std::size_t w = 0; w < 16; ++w) ASSERT_EQ(get_word(unit.wr_data, w), 0u);
    }
    if (unit.req_valid && unit.req_ready) {
      ASSERT_EQ(unit.req_write, 1);
      words_.push({unit.req_addr, unit.req_word});
    }
    if (bench_.chance(serve)) {
      ASSERT_EQ(writes_.valid(), port_.requests.valid());
      if (writes_.valid()) {
        const BusRequest other = port_.requests.pop();
        ASSERT_EQ(writes_.front(),
                  std::pair(static_cast<std::uint32_t>(other.address.value), other.bytes));
        written_.push_back(writes_.pop());
      }
    }
    if (bench_.chance(take)) {
      ASSERT_EQ(words_.valid(), cache_.valid());
      if (words_.valid()) {
        const MarkRequest other = cache_.pop();
        ASSERT_EQ(words_.front(),
                  std::pair(static_cast<std::uint32_t>(other.address.value), other.word));
        marked_.push_back(words_.pop());
      }
    }
    beu_.clock();
    cache_.clock();
    port_.clock();
    writes_.clock();
    words_.clock();
    bench_.cycle();
    bench_.settle();
  }

  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  Bench<Vbit_encoding> bench_;
  model::PaperConfig config_;
  model::BusPort port_{"clear", config_.bus};
  model::Queue<MarkRequest> cache_{2};
  model::BitEncodingUnit beu_{config_, port_, cache_};
  model::Queue<Pair> writes_{4};
  model::Queue<Pair> words_{2};
  std::deque<std::uint32_t> nodes_;  ///< to come
  bool offered_ = false;
  std::vector<Pair> written_;
  std::vector<Pair> marked_;
};

TEST(RtlBitEncoding, ClearsAllTheMarksAndNothingElse) {
  Lockstep lockstep(1);
  for (const std::uint32_t bytes : {0u, 4u, 8u, 60u, 64u, 68u, 128u, 4096u, 100004u}) {
    for (const unsigned serve : {100u, 40u}) lockstep.clear(bytes, serve);
    if (HasFatalFailure()) return;
  }
  for (int i = 0; i < 300; ++i) {
    lockstep.clear(lockstep.bench().random() % 500 * 4, 20 + lockstep.bench().random() % 81);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(lockstep.bench().failed_assertions(), 0);
}

TEST(RtlBitEncoding, WritesTheWordsOfTheReference) {
  Lockstep lockstep(2);
  Bench<Vbit_encoding>& bench = lockstep.bench();
  lockstep.mark({}, 5, 100, 100);
  lockstep.mark({1}, 0, 100, 100);
  for (const auto& [send, take] : {std::pair{100u, 100u}, {30u, 100u}, {100u, 30u}, {60u, 60u}}) {
    for (int i = 0; i < 100; ++i) {
      const int depth = static_cast<int>(bench.random() % 17);
      // From a few to nearly all nodes, so that words hold one mark as well as 32.
      const std::uint32_t count = bench.random() % (1u << bench.random() % 13);
      std::set<std::uint32_t> nodes;
      for (std::uint32_t n = 0; n < count; ++n) nodes.insert(bench.random() % (2u << depth));
      lockstep.clear(bench.random() % 64 * 4, 70);
      lockstep.mark(nodes, depth, send, take);
      if (HasFatalFailure()) return;
    }
    std::set<std::uint32_t> all;
    for (std::uint32_t n = 0; n < 4096; ++n) all.insert(n);
    lockstep.mark(all, 11, send, take);
  }
  EXPECT_EQ(bench.failed_assertions(), 0);
}

TEST(RtlBitEncoding, SaysWhenNodesAreOutOfOrderOrTooMany) {
  Bench<Vbit_encoding> bench;
  auto& unit = bench.unit;
  unit.start_clear = unit.start_marks = unit.mark_valid = 0;
  unit.marks = kMarks;
  unit.mark_bytes = 64;
  unit.wr_ready = unit.req_ready = 1;
  bench.reset();
  unit.nodes = 2;
  unit.start_marks = 1;
  bench.cycle();
  unit.start_marks = 0;
  unit.mark_valid = 1;
  for (const std::uint32_t index : {500u, 300u, 301u}) {
    unit.mark_index = index;
    bench.cycle();
  }
  unit.mark_valid = 0;
  EXPECT_EQ(bench.failed_assertions(), 1) << "out of order";
  for (int i = 0; i < 3; ++i) bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 2) << "too many";
}

}  // namespace
}  // namespace fasttree::rtl
