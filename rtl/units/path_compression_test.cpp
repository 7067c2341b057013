// SPDX-License-Identifier: Apache-2.0
// The PCU against the reference, and its cycles against the model's unit with the same cache.
#include "model/units/path_compression.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <vector>

#include "Vpath_compression.h"
#include "Vpath_compression_slow.h"
#include "Vpath_compression_wide.h"
#include "reference/path_compression.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {
namespace {

using model::Address;
using model::BusRequest;
using model::MarkRequest;

constexpr std::uint32_t kMarks = 0x40001000;
constexpr std::uint32_t kNodes = 0x7ff10000;

/// Leaves and what the steps before leave for the unit; links as the reference's.
struct Case {
  int depth;
  reference::LeafTable leaves;
  reference::InternalNodes nodes;
  std::map<std::uint32_t, std::uint32_t> marks;  ///< words that are not zero
  reference::Links links;

  Case(const std::set<std::uint32_t>& codes, int tree_depth) : depth(tree_depth) {
    leaves.code.assign(codes.begin(), codes.end());
    for (std::size_t j = 1; j < leaves.size(); ++j) {
      const int m = reference::highest_different_bit(leaves.code[j - 1], leaves.code[j]);
      nodes.node_index.push_back(reference::ancestor_node_index(leaves.code[j], m));
    }
    for (const std::uint32_t index : nodes.node_index) marks[index / 32] |= 1u << index % 32;
    if (depth <= 20) {
      links =
          reference::path_compression(leaves, nodes, reference::bit_encoding(nodes, depth), depth);
    } else {
      climb_all();
    }
  }

 private:
  // A bitmap of 2^31 marks would be too large for a test: ranks by search instead.
  void climb_all() {
    links.lower.resize(nodes.size());
    links.upper.resize(nodes.size());
    const auto link = [&](std::uint32_t index, std::uint32_t child) {
      while (index != 1u << depth) {
        const reference::Step step = reference::climb(index);
        ++links.climb_steps;
        const auto found =
            std::lower_bound(nodes.node_index.begin(), nodes.node_index.end(), step.parent);
        if (found != nodes.node_index.end() && *found == step.parent) {
          const auto rank = static_cast<std::size_t>(found - nodes.node_index.begin());
          (step.upper_child ? links.upper : links.lower)[rank] = child;
          return;
        }
        index = step.parent;
      }
      links.root = child;
    };
    for (std::uint32_t j = 0; j < leaves.size(); ++j) {
      link(reference::leaf_node_index(leaves.code[j]), j | kDeviceLeaf);
    }
    for (std::uint32_t j = 0; j < nodes.size(); ++j) link(nodes.node_index[j], j);
  }
};

/// Percent a cycle; the cache looks for up to `cache_delay` more cycles.
struct Manner {
  unsigned stream = 100, link = 100, ask = 100;
  std::uint32_t cache_delay = 0;
};

/// A cache for tests: two requests, one at a time, delays by the number of the request.
class Cache {
 public:
  Cache(const std::map<std::uint32_t, std::uint32_t>& marks, std::uint32_t most, std::uint32_t seed)
      : marks_(marks), most_(most), random_(seed) {}
  model::Queue<MarkRequest> requests{2};
  model::Queue<std::uint32_t> answers{2};

  void tick() {
    if (!requests.valid()) return;
    if (wait_ > 0) {
      --wait_;
      return;
    }
    if (!answers.ready()) return;
    const auto found =
        marks_.find(static_cast<std::uint32_t>(requests.pop().address.value - kMarks) / 4);
    answers.push(found == marks_.end() ? 0 : found->second);
    if (most_ > 0) wait_ = random_() % 4 == 0 ? random_() % most_ : 0;
  }
  void clock() {
    requests.clock();
    answers.clock();
  }

 private:
  const std::map<std::uint32_t, std::uint32_t>& marks_;
  std::uint32_t most_;
  std::mt19937 random_;
  std::uint32_t wait_ = 0;
};

/// Cycles of the model's unit, and its account of them.
std::uint64_t model_cycles(const Case& tree, const Manner& manner, std::uint32_t step_cycles,
                           model::Activity& activity) {
  model::PaperConfig config;
  config.path_compression.step_cycles = step_cycles;
  model::BusPort reads("reads", config.bus), links("links", config.bus);
  Cache cache(tree.marks, manner.cache_delay, 77);
  model::PathCompressionUnit pcu(config, reads, links, cache.requests, cache.answers);
  pcu.start(Address(0), static_cast<std::uint32_t>(tree.leaves.size()), Address(kMarks),
            Address(kNodes), static_cast<std::uint32_t>(tree.depth));
  // The leaf codes are there before it begins, as they are for the RTL.
  std::uint64_t cycles = 0;
  for (bool begun = false; !pcu.done();) {
    begun = begun || reads.data.visible() > 0;
    if (begun) ++cycles;
    pcu.tick();
    while (reads.requests.valid()) {
      const BusRequest request = reads.requests.pop();
      std::vector<std::uint8_t> bytes(request.bytes);
      std::memcpy(
          bytes.data(),
          reinterpret_cast<const std::uint8_t*>(tree.leaves.code.data()) + request.address.value,
          bytes.size());
      reads.data.push(bytes.data(), bytes.size());
    }
    if (links.requests.valid()) links.requests.pop();
    cache.tick();
    cache.clock();
    reads.clock();
    links.clock();
  }
  activity = pcu.activity().back();
  return cycles;
}

template <typename Rtl>
class Climber {
 public:
  explicit Climber(std::uint32_t seed) : bench_(seed) {
    bench_.unit.start = bench_.unit.rd_valid = bench_.unit.ans_valid = 0;
    bench_.unit.wr_ready = bench_.unit.req_ready = 0;
    bench_.reset();
    EXPECT_EQ(bench_.unit.done, 1);
  }

  /// The cycles it takes.
  std::uint64_t run(const Case& tree, const Manner& manner) {
    auto& unit = bench_.unit;
    Cache cache(tree.marks, manner.cache_delay, 77);
    std::vector<std::uint32_t> lower(tree.nodes.size()), upper(tree.nodes.size());
    std::size_t links = 0;
    const std::size_t beat_words = sizeof unit.rd_data / 4;
    std::size_t next = 0;
    unit.leaves = static_cast<std::uint32_t>(tree.leaves.size());
    unit.depth = static_cast<std::uint8_t>(tree.depth);
    unit.marks = kMarks;
    unit.nodes = kNodes;
    unit.ans_valid = 0;
    unit.start = 1;
    bench_.cycle();
    unit.start = 0;
    bench_.settle();
    activity_.fill(0);
    std::uint64_t cycles = 0;
    bool rd_valid = false, stuck_request = false;
    std::uint32_t request = 0;
    for (; !unit.done; ++cycles) {
      EXPECT_LT(cycles, 2'000'000u);
      if (cycles >= 2'000'000u) break;
      rd_valid = next < tree.leaves.size() && (rd_valid || bench_.chance(manner.stream));
      unit.rd_valid = rd_valid;
      for (std::size_t w = 0; w < beat_words; ++w) {
        set_word(unit.rd_data, w,
                 rd_valid && next + w < tree.leaves.size() ? tree.leaves.code[next + w]
                                                           : bench_.random());
      }
      unit.wr_ready = bench_.chance(manner.link);
      const bool ask = bench_.chance(manner.ask);
      unit.req_ready = ask && cache.requests.ready();
      unit.ans_valid = cache.answers.valid();
      unit.ans_word = cache.answers.valid() ? cache.answers.front() : bench_.random();
      bench_.settle();
      if (unit.rd_valid && unit.rd_ready) {
        next += beat_words;
        rd_valid = false;
      }
      if (stuck_request) {
        EXPECT_EQ(unit.req_valid, 1);
        EXPECT_EQ(unit.req_addr, request);
      }
      request = unit.req_addr;
      stuck_request = unit.req_valid && !unit.req_ready;
      if (unit.req_valid && unit.req_ready) {
        EXPECT_EQ(unit.req_write, 0);
        // The last word of marks is that of node 2^(depth + 1) - 1.
        EXPECT_LE((unit.req_addr - kMarks) / 4, ((std::uint64_t{2} << tree.depth) - 1) / 32);
        cache.requests.push({Address(unit.req_addr), false, 0});
      }
      if (unit.ans_valid && unit.ans_ready) cache.answers.drop();
      if (unit.wr_valid && unit.wr_ready) {
        const std::uint32_t at = unit.wr_addr - kNodes;
        EXPECT_EQ(unit.wr_bytes, 4);
        EXPECT_EQ(at % 16 & ~4u, 0u);
        const std::uint32_t child = get_word(unit.wr_data, at / 4 % 2);
        if (at / 16 < lower.size()) (at % 16 == 4 ? upper : lower)[at / 16] = child;
        EXPECT_LT(at / 16, lower.size());
        ++links;
      }
      ++activity_[unit.activity];
      cache.tick();
      cache.clock();
      bench_.cycle();
      bench_.settle();
    }
    EXPECT_EQ(links, 2 * tree.nodes.size()) << "each child once";
    EXPECT_EQ(lower, tree.links.lower);
    EXPECT_EQ(upper, tree.links.upper);
    EXPECT_EQ(unit.root, tree.links.root);
    EXPECT_EQ(unit.steps, tree.links.climb_steps);
    EXPECT_EQ(next, (tree.leaves.size() + beat_words - 1) / beat_words * beat_words)
        << "the whole stream, and no more";
    return cycles;
  }

  Bench<Rtl>& bench() { return bench_; }
  std::uint64_t activity(unsigned what) const { return activity_[what]; }

 private:
  Bench<Rtl> bench_;
  std::array<std::uint64_t, 16> activity_{};
};

template <typename Random>
Case random_tree(const Random& random) {
  const int depth = static_cast<int>(random() % 31);
  const std::uint32_t count = 1 + random() % (1u << random() % 12);
  // Scattered, or close together as the cells of a surface are.
  const std::uint32_t mask = (1u << depth) - 1;
  const std::uint32_t base = random();
  const std::uint32_t spread = random() % 2 == 0 ? ~0u : (1u << random() % 12) - 1;
  std::set<std::uint32_t> codes;
  for (std::uint32_t i = 0; i < count; ++i) codes.insert((base ^ (random() & spread)) & mask);
  return Case(codes, depth);
}

template <typename Rtl>
void check(std::uint32_t seed, std::uint32_t step_cycles, int trees) {
  Climber<Rtl> climber(seed);
  const auto random = [&] { return climber.bench().random(); };
  climber.run(Case({}, 7), {});
  climber.run(Case({0}, 0), {});
  climber.run(Case({0}, 30), {});
  climber.run(Case({5}, 12), {});
  climber.run(Case({0, 1}, 1), {});
  climber.run(Case({0, (1u << 30) - 1}, 30), {});
  for (int i = 0; i < trees; ++i) {
    SCOPED_TRACE(i);
    const Case tree = random_tree(random);
    climber.run(tree, {.stream = 20 + random() % 81,
                       .link = 10 + random() % 91,
                       .ask = 10 + random() % 91,
                       .cache_delay = random() % 40});
    Manner manner;
    manner.cache_delay = i % 3 == 0 ? 20 : 0;
    const std::uint64_t cycles = climber.run(tree, manner);
    model::Activity expected;
    const std::uint64_t model = model_cycles(tree, manner, step_cycles, expected);
    EXPECT_EQ(cycles, model + 1) << "a cycle for the first leaf";
    EXPECT_EQ(climber.activity(1), expected.busy_cycles);
    EXPECT_EQ(climber.activity(4), expected.stalled_cycles[2]);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_EQ(climber.bench().failed_assertions(), 0);
}

TEST(RtlPathCompression, LinksAsTheReferenceAndInTheModelsCycles) {
  check<Vpath_compression>(1, 1, 1000);
}
TEST(RtlPathCompression, WorksWithOtherBusesAndSlowerSteps) {
  check<Vpath_compression_slow>(2, 3, 80);
  check<Vpath_compression_wide>(3, 2, 80);
}

TEST(RtlPathCompression, TakesTwoCyclesALook) {
  std::set<std::uint32_t> codes;
  for (std::uint32_t i = 0; i < 5000; ++i) codes.insert(i * 2654435761u >> 15);
  const Case tree(codes, 17);
  Climber<Vpath_compression> climber(4);
  const std::uint64_t cycles = climber.run(tree, {});
  EXPECT_LE(cycles, 2 * tree.links.climb_steps + 3);
}

TEST(RtlPathCompression, SaysWhenAnAnswerOrACodeCannotBe) {
  Bench<Vpath_compression> bench;
  auto& unit = bench.unit;
  unit.start = unit.rd_valid = unit.ans_valid = unit.req_ready = unit.wr_ready = 0;
  bench.reset();
  unit.ans_valid = 1;
  bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 1) << "not asked for";
  unit.ans_valid = 0;
  unit.leaves = 1;
  unit.depth = 3;
  unit.marks = kMarks;
  unit.nodes = kNodes + 4;
  unit.start = 1;
  bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 2) << "nodes not aligned";
  unit.start = 0;
  unit.rd_valid = 1;
  set_word(unit.rd_data, 0, 8);
  bench.cycle();
  EXPECT_EQ(bench.failed_assertions(), 3) << "a code of four bits";
}

}  // namespace
}  // namespace fasttree::rtl
