// SPDX-License-Identifier: Apache-2.0
#include "model/memory/address_map.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>
#include <tuple>

namespace fasttree::model {
namespace {

DramSpec dual() {
  return memory_preset("lpddr3-1600-dual").value().dram;
}

TEST(AddressMap, BurstInterleaveChangesChannelWithEveryBurst) {
  ControllerConfig controller;
  controller.bank_hash = false;
  const AddressMap map(dual(), controller);
  EXPECT_EQ(map.locate(Address(0)), (DramLocation{0, 0, 0, 0}));
  EXPECT_EQ(map.locate(Address(31)), (DramLocation{0, 0, 0, 0}));
  EXPECT_EQ(map.locate(Address(32)), (DramLocation{1, 0, 0, 0}));
  EXPECT_EQ(map.locate(Address(64)), (DramLocation{0, 0, 0, 8}));
  EXPECT_EQ(map.locate(Address(8192)), (DramLocation{0, 1, 0, 0}));
  EXPECT_EQ(map.locate(Address(65536)), (DramLocation{0, 0, 1, 0}));
}

TEST(AddressMap, RowInterleaveChangesChannelWithEveryBlock) {
  ControllerConfig controller;
  controller.bank_hash = false;
  controller.interleave = Interleave::row;
  const AddressMap map(dual(), controller);
  EXPECT_EQ(map.locate(Address(32)), (DramLocation{0, 0, 0, 8}));
  EXPECT_EQ(map.locate(Address(4096)), (DramLocation{0, 1, 0, 0}));
  EXPECT_EQ(map.locate(Address(32768)), (DramLocation{1, 0, 0, 0}));
  EXPECT_EQ(map.locate(Address(65536)), (DramLocation{0, 0, 1, 0}));
}

TEST(AddressMap, BankAboveRowKeepsAStreamInItsBank) {
  ControllerConfig controller;
  controller.bank_hash = false;
  controller.address_order = AddressOrder::bank_row_column;
  const AddressMap map(memory_preset("lpddr3-1600").value().dram, controller);
  EXPECT_EQ(map.locate(Address(4096)), (DramLocation{0, 0, 1, 0}));
  EXPECT_EQ(map.locate(Address(std::uint64_t{4096} * 32768)), (DramLocation{0, 1, 0, 0}));
}

TEST(AddressMap, HashSeparatesArraysAPowerOfTwoApart) {
  const DramSpec spec = memory_preset("lpddr3-1600").value().dram;
  const AddressMap map(spec, ControllerConfig{});
  for (int bit = 15; bit < 30; ++bit) {
    EXPECT_NE(map.locate(Address(0)).bank, map.locate(Address(std::uint64_t{1} << bit)).bank)
        << bit;
  }
}

RC_GTEST_PROP(AddressMap, IsOneToOne, ()) {
  DramSpec spec;
  const auto power = [](int most) { return 1u << *rc::gen::inRange(0, most + 1); };
  spec.channels = power(2);
  spec.banks = power(3);
  spec.rows = power(4);
  spec.columns = 8 * power(3);
  spec.channel_bits = 8 * power(3);
  ControllerConfig controller;
  controller.bank_hash = *rc::gen::arbitrary<bool>();
  controller.interleave = *rc::gen::element(Interleave::burst, Interleave::row);
  controller.address_order =
      *rc::gen::element(AddressOrder::row_bank_column, AddressOrder::bank_row_column);
  // A block is at least a burst, and no more than a channel.
  controller.row_interleave_bytes = spec.access_bytes();
  const int doublings = *rc::gen::inRange(0, 8);
  for (int i = 0; i < doublings && controller.row_interleave_bytes < spec.channel_bytes(); ++i) {
    controller.row_interleave_bytes *= 2;
  }
  const AddressMap map(spec, controller);
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>> seen;
  const std::uint64_t bytes = spec.channel_bytes() * spec.channels;
  for (std::uint64_t a = 0; a < bytes; a += spec.access_bytes()) {
    const DramLocation at = map.locate(Address(a));
    RC_ASSERT(at.channel < spec.channels && at.bank < spec.banks && at.row < spec.rows &&
              at.column < spec.columns);
    RC_ASSERT(at.channel == map.channel(Address(a)));
    RC_ASSERT(seen.emplace(at.channel, at.bank, at.row, at.column).second);
  }
}

}  // namespace
}  // namespace fasttree::model
