// SPDX-License-Identifier: Apache-2.0
// The bus with memory behind it and a driver for each of its clients, for its tests.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/memory/byte_store.h"
#include "model/memory/make_memory.h"
#include "model/system/pipe_memory.h"
#include "rtl/bench/axi_memory.h"
#include "rtl/bench/axi_ports.h"
#include "rtl/bench/bench.h"

namespace fasttree::rtl {

inline constexpr std::uint32_t kStoreBytes = 1 << 17;
inline constexpr std::array<std::uint32_t, 8> kBlocks = {32, 32, 64, 64, 64, 64, 8, 8};
inline constexpr std::size_t kClear = 5;
inline constexpr std::size_t kCache = 6;

inline std::unique_ptr<model::Memory> memory_of(const std::string& preset) {
  return model::make_memory(model::memory_preset(preset).value());
}

struct WriteRequest {
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
  std::array<std::uint8_t, 64> block{};  ///< image of the aligned block
};

template <typename Unit>
class BusBench {
 public:
  BusBench(std::unique_ptr<model::Memory> memory, const AxiMemoryOptions& options)
      : bench(options.seed),
        store(kStoreBytes),
        expected(kStoreBytes),
        memory_(std::move(memory)),
        axi(*memory_, store, options),
        bus_bytes_(options.bus_bytes) {
    for (std::uint32_t i = 0; i < kStoreBytes; i += 4) {
      const std::uint32_t word = bench.random();
      std::memcpy(expected.data() + i, &word, 4);
    }
    store.write(model::Address(0), expected.data(), kStoreBytes);
    auto& unit = bench.unit;
    unit.cancel = unit.clear = unit.stream_start = unit.rdq_valid = unit.wr_valid = 0;
    unit.rd_ready = unit.rdd_ready = 1;
    unit.window_begin = 0;
    unit.window_end = kStoreBytes;
    unit.m_axi_rvalid = unit.m_axi_bvalid = 0;
  }

  /// One cycle. What was set before is offered, and stays offered until it is taken.
  void step() {
    auto& unit = bench.unit;
    for (std::size_t c = 0; c < writes.size(); ++c) {
      if (writes[c] && !(unit.wr_valid >> c & 1)) offer(c, *writes[c]);
    }
    unit.rdq_valid = read.has_value();
    if (read) unit.rdq_addr = *read;
    axi.drive(wires_);
    drive_unit(wires_, unit, bus_bytes_);
    bench.settle();
    look_at_unit(unit, wires_, bus_bytes_);
    axi.clock(wires_);
    read_beat = wires_.r_valid && wires_.r_ready;
    write_beat = wires_.w_valid && wires_.w_ready;
    // What is taken in this cycle. A read sees the writes before it.
    if (unit.rdd_valid && unit.rdd_ready) take_word();
    if (read && unit.rdq_ready) {
      std::uint64_t word = 0;
      std::memcpy(&word, expected.data() + *read % kStoreBytes, 8);
      words_to_come.push_back({*read, outside(*read) ? 0 : word});
      read.reset();
    }
    if (unit.rd_valid && unit.rd_ready) take_beat();
    for (std::size_t c = 0; c < writes.size(); ++c) {
      if (!writes[c] || !(unit.wr_ready >> c & 1)) continue;
      if (!outside(writes[c]->address)) {
        const std::uint32_t place = writes[c]->address & (kBlocks[c] - 1);
        std::memcpy(expected.data() + writes[c]->address, writes[c]->block.data() + place,
                    writes[c]->bytes);
      }
      taken_writes += 1;
      writes[c].reset();
    }
    bench.cycle();
    unit.stream_start = 0;
    for (std::size_t c = 0; c < writes.size(); ++c) {
      if (!writes[c]) unit.wr_valid &= static_cast<std::uint8_t>(~(1u << c));
    }
  }

  void start_stream(std::uint32_t address, std::uint32_t bytes) {
    bench.unit.stream_start = 1;
    bench.unit.stream_addr = address;
    bench.unit.stream_bytes = bytes;
    stream_at_ = address;
    stream_left = bytes;
  }

  /// Until the bus is quiet, the clients' last requests taken.
  bool settle(std::uint64_t cycles = 20000) {
    for (std::uint64_t i = 0; i < cycles; ++i) {
      bool offered = read.has_value() || bench.unit.stream_start;
      for (const auto& write : writes) offered |= write.has_value();
      bench.settle();
      if (!offered && bench.unit.quiet) return true;
      step();
    }
    return false;
  }

  /// A request as client c makes them, within `bytes` bytes from `from`, both aligned.
  WriteRequest random_write(std::size_t c, std::uint32_t from, std::uint32_t bytes) {
    WriteRequest request;
    const std::uint32_t block = kBlocks[c];
    const std::uint32_t first = bench.random() % (block / 4);
    const std::uint32_t words =
        bench.chance(50) ? block / 4 - first : 1 + bench.random() % (block / 4 - first);
    request.address = from + bench.random() % (bytes / block) * block + 4 * first;
    request.bytes = 4 * words;
    for (auto& byte : request.block) {
      byte = c == kClear ? 0 : static_cast<std::uint8_t>(bench.random());
    }
    return request;
  }

  bool store_is_as_expected() const {
    const auto bytes = store.view(model::Address(0), kStoreBytes);
    return std::equal(bytes.begin(), bytes.end(), expected.begin());
  }

  bool outside(std::uint32_t address) const {
    return address < bench.unit.window_begin ||
           (bench.unit.window_end != 0 && address >= bench.unit.window_end);
  }

  Bench<Unit> bench;
  model::ByteStore store;
  std::vector<std::uint8_t> expected;

 private:
  std::unique_ptr<model::Memory> memory_;

 public:
  AxiMemory axi;
  std::array<std::optional<WriteRequest>, 8> writes;
  std::optional<std::uint32_t> read;
  struct Word {
    std::uint32_t address;
    std::uint64_t value;
  };
  std::deque<Word> words_to_come;
  std::uint32_t stream_left = 0;  ///< bytes not taken
  std::uint64_t taken_writes = 0;
  bool read_beat = false, write_beat = false;  ///< crossed in the last cycle
  int wrong = 0;                               ///< words and beats that were not as expected

 private:
  void offer(std::size_t c, const WriteRequest& request) {
    auto& unit = bench.unit;
    set_word(unit.wr_addr, c, request.address);
    const std::uint64_t mask = std::uint64_t{0x7f} << (7 * c);
    unit.wr_bytes = (unit.wr_bytes & ~mask) | std::uint64_t{request.bytes} << (7 * c);
    for (std::size_t i = 0; i < 16; ++i) {
      std::uint32_t word = 0;
      std::memcpy(&word, request.block.data() + 4 * i, 4);
      set_word(unit.wr_data, 16 * c + i, word);
    }
    unit.wr_valid |= static_cast<std::uint8_t>(1u << c);
  }
  void take_word() {
    const std::uint64_t value = bench.unit.rdd_data;
    if (words_to_come.empty() || words_to_come.front().value != value) ++wrong;
    if (!words_to_come.empty()) words_to_come.pop_front();
  }
  void take_beat() {
    if (stream_left == 0) ++wrong;
    for (std::uint32_t i = 0; i < bus_bytes_ / 4 && stream_left > 0; ++i) {
      std::uint32_t word = 0;
      if (!outside(stream_at_)) std::memcpy(&word, expected.data() + stream_at_, 4);
      if (get_word(bench.unit.rd_data, i) != word) ++wrong;
      stream_at_ += 4;
      stream_left -= 4;
    }
  }

  std::uint32_t bus_bytes_;
  std::uint32_t stream_at_ = 0;
  AxiSignals wires_;
};

}  // namespace fasttree::rtl
