// SPDX-License-Identifier: Apache-2.0
// The registers behind a host that takes its time, or none.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "Vregisters.h"
#include "rtl/bench/bench.h"
#include "rtl/bench/grid_port.h"
#include "rtl/driver/fasttree_accel.h"

namespace fasttree::rtl {
namespace {

constexpr std::uint32_t kOrderWords = sizeof(ft_accel_order) / 4;
constexpr std::uint32_t kResultWords = sizeof(ft_accel_result) / 4;
constexpr std::size_t kRounds = 15, kWatchdog = 18;
/// Where the fields of ft_pkg::state_t are.
constexpr std::size_t kBusy = 0, kStage = 3, kError = 7, kResults = 15;

/// A host that offers, and takes answers, in `percent` of the cycles.
class Host {
 public:
  explicit Host(std::uint32_t seed, unsigned percent) : bench(seed), percent_(percent) {
    unit.s_axi_awvalid = unit.s_axi_wvalid = unit.s_axi_arvalid = 0;
    unit.s_axi_bready = unit.s_axi_rready = 0;
    unit.finished = 0;
    for (std::uint32_t w = 0; w <= kResultWords; ++w) set_word(unit.state, w, 0);
    bench.reset();
  }

  /// One cycle; pulses are counted.
  void cycle() {
    bench.cycle();
    starts += unit.start;
    cancels += unit.cancel;
    flushes += unit.flush;
  }

  void offer_write(std::uint32_t address, std::uint32_t data, unsigned strobes = 15) {
    unit.s_axi_awvalid = unit.s_axi_wvalid = 1;
    unit.s_axi_awaddr = static_cast<std::uint16_t>(address);
    unit.s_axi_wdata = data;
    unit.s_axi_wstrb = static_cast<std::uint8_t>(strobes);
  }

  void write(std::uint32_t address, std::uint32_t data, unsigned strobes = 15) {
    offer_write(address, data, strobes);
    unit.s_axi_awvalid = unit.s_axi_wvalid = 0;
    bool address_taken = false, data_taken = false, answered = false;
    while (!answered) {
      // What was offered stays offered.
      unit.s_axi_awvalid = !address_taken && (unit.s_axi_awvalid || bench.chance(percent_));
      unit.s_axi_wvalid = !data_taken && (unit.s_axi_wvalid || bench.chance(percent_));
      unit.s_axi_bready = bench.chance(percent_);
      bench.settle();
      address_taken |= unit.s_axi_awvalid && unit.s_axi_awready;
      data_taken |= unit.s_axi_wvalid && unit.s_axi_wready;
      answered = unit.s_axi_bvalid && unit.s_axi_bready;
      EXPECT_TRUE(!answered || (address_taken && data_taken)) << "an answer to nothing";
      EXPECT_EQ(unit.s_axi_bresp, 0);
      cycle();
    }
    unit.s_axi_awvalid = unit.s_axi_wvalid = unit.s_axi_bready = 0;
    bench.settle();
    EXPECT_FALSE(unit.s_axi_bvalid) << "answered twice";
  }

  std::uint32_t read(std::uint32_t address) {
    unit.s_axi_araddr = static_cast<std::uint16_t>(address);
    bool taken = false, answered = false;
    std::uint32_t data = 0;
    while (!answered) {
      unit.s_axi_arvalid = !taken && (unit.s_axi_arvalid || bench.chance(percent_));
      unit.s_axi_rready = bench.chance(percent_);
      bench.settle();
      answered = unit.s_axi_rvalid && unit.s_axi_rready;
      EXPECT_TRUE(!answered || taken) << "an answer to nothing";
      taken |= unit.s_axi_arvalid && unit.s_axi_arready;
      data = unit.s_axi_rdata;
      EXPECT_EQ(unit.s_axi_rresp, 0);
      cycle();
    }
    unit.s_axi_arvalid = unit.s_axi_rready = 0;
    bench.settle();
    EXPECT_FALSE(unit.s_axi_rvalid) << "answered twice";
    return data;
  }

  void busy(bool on) { set_bits(unit.state, kBusy, 1, on); }
  /// A build ends.
  void finish() {
    unit.finished = 1;
    cycle();
    unit.finished = 0;
  }

  Bench<Vregisters> bench;
  Vregisters& unit = bench.unit;
  int starts = 0, cancels = 0, flushes = 0;

 private:
  unsigned percent_;
};

TEST(RtlRegisters, KeepTheOrderByteByByte) {
  for (const unsigned percent : {100u, 40u}) {
    Host host(percent, percent);
    std::array<std::uint32_t, kOrderWords> expected{};
    expected[kRounds] = 8;
    expected[kWatchdog] = 1u << 20;
    for (int i = 0; i < 2000; ++i) {
      const std::uint32_t word = host.bench.random() % kOrderWords;
      const std::uint32_t data = host.bench.random();
      const unsigned strobes = host.bench.random() % 16;
      const bool busy = host.bench.chance(20);
      ASSERT_EQ(host.read(FT_ACCEL_ORDER + 4 * word), expected[word]);
      host.busy(busy);
      host.write(FT_ACCEL_ORDER + 4 * word, data, strobes);
      for (unsigned b = 0; b < 4 && !busy; ++b) {
        const std::uint32_t mask = 0xffu << (8 * b);
        if (strobes >> b & 1) expected[word] = (expected[word] & ~mask) | (data & mask);
      }
      for (std::uint32_t w = 0; w < kOrderWords; ++w) {
        ASSERT_EQ(get_word(host.unit.order, w), expected[w]) << i << ", word " << w;
      }
    }
    EXPECT_EQ(host.starts + host.cancels + host.flushes, 0);
  }
}

TEST(RtlRegisters, ShowTheStateAndNothingElsewhere) {
  Host host(3, 60);
  for (int i = 0; i < 50; ++i) {
    for (std::uint32_t w = 0; w < kResultWords; ++w) {
      set_word(host.unit.state, w, host.bench.random());
    }
    set_word(host.unit.state, kResultWords, host.bench.random() & ((1u << kResults) - 1));
    const std::uint32_t low = get_word(host.unit.state, 0);
    EXPECT_EQ(host.read(FT_ACCEL_STATUS),
              (low & 7) | (low >> kStage & 15) << 4 | (low >> kError & 255) << 8);
    for (std::uint32_t w = 0; w < kResultWords; ++w) {
      const std::uint32_t expected = get_word(host.unit.state, w) >> kResults |
                                     get_word(host.unit.state, w + 1) << (32 - kResults);
      EXPECT_EQ(host.read(FT_ACCEL_RESULT + 4 * w), expected) << w;
    }
  }
  EXPECT_EQ(host.read(FT_ACCEL_ID), FT_ACCEL_ID_VALUE);
  EXPECT_EQ(host.read(FT_ACCEL_VERSION), 1u);
  EXPECT_EQ(host.read(FT_ACCEL_CAPABILITIES), 0x20040410u);
  for (const std::uint32_t address :
       {0x00cu, FT_ACCEL_ORDER + 4 * kOrderWords, FT_ACCEL_RESULT + 4 * kResultWords, 0xffcu}) {
    host.write(address, ~0u);
    EXPECT_EQ(host.read(address), 0u) << address;
  }
  EXPECT_EQ(host.starts + host.cancels + host.flushes, 0);
}

/// One pulse a write, and during a build only the cancel's.
TEST(RtlRegisters, StartCancelAndFlush) {
  Host host(4, 70);
  host.write(FT_ACCEL_CONTROL, 7, 14);
  EXPECT_EQ(host.starts + host.cancels + host.flushes, 0) << "by the other bytes";
  host.write(FT_ACCEL_CONTROL, FT_ACCEL_START);
  EXPECT_EQ(host.starts, 1);
  host.write(FT_ACCEL_CONTROL, FT_ACCEL_FLUSH);
  EXPECT_EQ(host.flushes, 1);
  EXPECT_EQ(host.cancels, 0);
  host.busy(true);
  host.write(FT_ACCEL_CONTROL, 7);
  EXPECT_EQ(host.starts, 1);
  EXPECT_EQ(host.flushes, 1);
  EXPECT_EQ(host.cancels, 1);
}

TEST(RtlRegisters, RaiseTheInterruptWhereItIsEnabled) {
  Host host(5, 100);
  host.finish();
  EXPECT_EQ(host.read(FT_ACCEL_IRQ_STATUS), 1u);
  EXPECT_FALSE(host.unit.irq);
  host.write(FT_ACCEL_IRQ_ENABLE, 1);
  EXPECT_EQ(host.read(FT_ACCEL_IRQ_ENABLE), 1u);
  EXPECT_TRUE(host.unit.irq);
  host.write(FT_ACCEL_IRQ_STATUS, 0);
  EXPECT_TRUE(host.unit.irq) << "cleared by zero";
  host.write(FT_ACCEL_IRQ_STATUS, 1);
  EXPECT_FALSE(host.unit.irq);
  EXPECT_EQ(host.read(FT_ACCEL_IRQ_STATUS), 0u);
  // A build that ends in the very cycle of the clear is not forgotten.
  host.offer_write(FT_ACCEL_IRQ_STATUS, 1);
  host.unit.s_axi_bready = 1;
  host.finish();
  EXPECT_TRUE(host.unit.irq);
}

/// A host that has the next one ready: it is not taken before the answer to the one before was.
TEST(RtlRegisters, TakeOneOfEachDirectionAtATime) {
  Host host(6, 100);
  auto& unit = host.unit;
  host.offer_write(FT_ACCEL_ORDER, 1);
  unit.s_axi_arvalid = 1;
  unit.s_axi_araddr = FT_ACCEL_ID;
  host.cycle();
  host.offer_write(FT_ACCEL_ORDER, 2);
  unit.s_axi_arvalid = 1;
  unit.s_axi_araddr = FT_ACCEL_VERSION;
  for (int i = 0; i < 5; ++i) {
    host.bench.settle();
    EXPECT_TRUE(unit.s_axi_bvalid);
    EXPECT_TRUE(unit.s_axi_rvalid);
    EXPECT_FALSE(unit.s_axi_awready);
    EXPECT_FALSE(unit.s_axi_wready);
    EXPECT_FALSE(unit.s_axi_arready);
    EXPECT_EQ(unit.s_axi_rdata, FT_ACCEL_ID_VALUE);
    EXPECT_EQ(get_word(unit.order, 0), 1u);
    host.cycle();
  }
  unit.s_axi_bready = unit.s_axi_rready = 1;
  host.cycle();
  host.bench.settle();
  EXPECT_TRUE(unit.s_axi_awready);
  EXPECT_TRUE(unit.s_axi_arready);
  host.cycle();
  EXPECT_EQ(get_word(unit.order, 0), 2u);
  EXPECT_EQ(unit.s_axi_rdata, 1u);
}

}  // namespace
}  // namespace fasttree::rtl
