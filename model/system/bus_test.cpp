// SPDX-License-Identifier: Apache-2.0
#include "model/system/bus.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <deque>

#include "model/system/pipe_memory.h"
#include "model/system/stream.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

using test::PipeMemory;
using test::PipeSettings;

BusRequest read_of(std::uint64_t address, std::uint32_t bytes) {
  BusRequest request;
  request.address = Address(address);
  request.bytes = bytes;
  return request;
}

struct Bench {
  Bench(const PaperConfig::Bus& config, const PipeSettings& pipe)
      : memory(pipe), store(1 << 16), bus(config, 1000, memory, store) {}
  void step() {
    bus.tick();
    bus.clock();
  }
  PipeMemory memory;
  ByteStore store;
  Bus bus;
};

/// Random reads and writes at two ports, each in a half of the memory: every port sees its own
/// requests in order, whatever the widths, bursts and latencies.
RC_GTEST_PROP(Bus, KeepsEachPortsOrder, ()) {
  PaperConfig::Bus config;
  config.bytes = 4u << *rc::gen::inRange(0, 5);
  config.duplex = *rc::gen::arbitrary<bool>();
  config.commands_per_cycle = *rc::gen::inRange(1u, 4u);
  config.reads_in_flight = *rc::gen::inRange(1u, 20u);
  PipeSettings pipe;
  pipe.access_bytes = 8u << *rc::gen::inRange(0, 4);
  pipe.latency_ps = *rc::gen::inRange<std::uint64_t>(0, 60000);
  pipe.jitter_ps = *rc::gen::inRange<std::uint64_t>(0, 60000);
  pipe.queue = *rc::gen::inRange<std::size_t>(1, 30);
  fasttree::test::Random random(*rc::gen::inRange<std::uint64_t>(1, 1000));
  Bench bench(config, pipe);
  struct Side {
    BusPort* port = nullptr;
    std::vector<std::uint8_t> expected = std::vector<std::uint8_t>(1 << 15);
    std::deque<std::uint8_t> to_come;
    int left = 60;
  };
  Side sides[2];
  sides[0].port = &bench.bus.add_port("a");
  sides[1].port = &bench.bus.add_port("b");
  int cycles = 0;
  while (sides[0].left > 0 || sides[1].left > 0 || !bench.bus.done()) {
    for (std::uint32_t s = 0; s < 2; ++s) {
      Side& side = sides[s];
      while (side.port->data.visible() > 0) {
        std::uint8_t byte = 0;
        side.port->data.pop(&byte, 1);
        RC_ASSERT(!side.to_come.empty());
        RC_ASSERT(byte == side.to_come.front());
        side.to_come.pop_front();
      }
      // What has not come back has to fit the port.
      if (side.left == 0 || !side.port->requests.ready() || side.to_come.size() > 400) continue;
      const std::uint32_t bytes = 1 + random.below(64);
      const std::uint32_t at = random.below(200);
      BusRequest request = read_of(at + (s << 15), bytes);
      request.write = random.below(2) == 0;
      for (std::uint32_t i = 0; i < bytes; ++i) {
        request.data[i] = static_cast<std::uint8_t>(random.below(256));
        if (request.write) {
          side.expected[at + i] = request.data[i];
        } else {
          side.to_come.push_back(side.expected[at + i]);
        }
      }
      side.port->requests.push(request);
      --side.left;
    }
    bench.step();
    RC_ASSERT(++cycles < 100000);
  }
  for (std::uint32_t s = 0; s < 2; ++s) {
    const auto bytes = bench.store.view(Address(s << 15), 1 << 15);
    RC_ASSERT(std::equal(bytes.begin(), bytes.end(), sides[s].expected.begin()));
  }
}

std::uint64_t stream_cycles(const PaperConfig::Bus& config, bool read, bool write) {
  PipeSettings pipe;
  pipe.latency_ps = 10000;
  Bench bench(config, pipe);
  BusPort& in = bench.bus.add_port("in");
  BusPort& out = bench.bus.add_port("out");
  StreamReader reader(in, 64);
  BlockWriter writer;
  reader.start(Address(0), read ? 16384 : 0, Purpose::pairs);
  writer.start(out, 32, Address(32768), Purpose::pairs);
  std::uint64_t left = write ? 16384 : 0;
  std::uint64_t cycles = 0;
  while (reader.left() > 0 || left > 0 || !bench.bus.done()) {
    reader.tick();
    std::array<std::uint8_t, 64> bytes{};
    const std::size_t width = config.bytes;
    if (reader.left() > 0 && reader.available() >= width) reader.take(bytes.data(), width);
    if (left > 0 && writer.ready(width)) {
      writer.put(bytes.data(), width);
      left -= width;
    }
    bench.step();
    ++cycles;
  }
  return cycles;
}

TEST(Bus, MovesItsWidthACycleSharedOrNot) {
  PaperConfig::Bus config;
  EXPECT_NEAR(static_cast<double>(stream_cycles(config, true, false)), 1024, 40);
  EXPECT_NEAR(static_cast<double>(stream_cycles(config, false, true)), 1024, 40);
  EXPECT_NEAR(static_cast<double>(stream_cycles(config, true, true)), 2048, 60);
  config.duplex = true;
  EXPECT_NEAR(static_cast<double>(stream_cycles(config, true, true)), 1024, 40);
}

TEST(Bus, TakesAWholeBeatForAShortWrite) {
  Bench bench({}, {});
  BusPort& port = bench.bus.add_port("port");
  BusRequest request = read_of(4, 4);
  request.write = true;
  std::uint64_t busy = 0;
  for (int i = 0; i < 10; ++i) {
    port.requests.push(request);
    bench.bus.clock();
    bench.step();
    busy = bench.bus.activity().back().busy_cycles;
  }
  EXPECT_EQ(busy, 10u);
  EXPECT_EQ(bench.bus.moved_bytes(), 40u);
}

TEST(Bus, CountsBytesByPurpose) {
  Bench bench({}, {});
  BusPort& port = bench.bus.add_port("port");
  BusRequest request = read_of(0, 24);
  request.purpose = Purpose::marks;
  port.requests.push(request);
  request.write = true;
  request.purpose = Purpose::links;
  port.requests.push(request);
  for (int i = 0; i < 200; ++i) bench.step();
  const std::vector<Traffic> traffic = bench.bus.take_traffic();
  ASSERT_EQ(traffic.size(), 2u);
  EXPECT_EQ(traffic[0].purpose, "marks");
  EXPECT_EQ(traffic[0].read_bytes, 24u);
  EXPECT_EQ(traffic[1].purpose, "links");
  EXPECT_EQ(traffic[1].write_bytes, 24u);
  EXPECT_TRUE(bench.bus.take_traffic().empty());
}

TEST(Bus, RefusesToLeaveTheMemory) {
  Bench bench({}, {});
  BusPort& port = bench.bus.add_port("port");
  BusRequest request = read_of((1 << 16) - 4, 8);
  request.write = true;
  port.requests.push(request);
  for (int i = 0; i < 200; ++i) bench.step();
  EXPECT_TRUE(bench.bus.strayed());
}

}  // namespace
}  // namespace fasttree::model
