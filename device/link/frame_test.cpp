// SPDX-License-Identifier: Apache-2.0
#include "device/link/frame.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cstring>
#include <string_view>
#include <vector>

#include "device/link/crc32c.h"

namespace fasttree::device {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

TEST(Crc32c, KnownValues) {
  // RFC 3720, B.4, and the check value of the catalogue of CRCs.
  EXPECT_EQ(crc32c(bytes_of("123456789")), 0xE3069283u);
  const std::vector<std::byte> zeros(32), ones(32, std::byte{0xFF});
  EXPECT_EQ(crc32c(zeros), 0x8A9136AAu);
  EXPECT_EQ(crc32c(ones), 0x62A8AB43u);
  EXPECT_EQ(crc32c({}), 0u);
}

TEST(Crc32c, InstructionAndTablesAgreeInPiecesToo) {
  EXPECT_TRUE(rc::check("crc", [](const std::vector<std::uint8_t>& data, std::size_t at) {
    const auto all = std::as_bytes(std::span(data));
    const std::size_t cut = data.empty() ? 0 : at % (data.size() + 1);
    RC_ASSERT(crc32c(all) == crc32c_portable(all));
    RC_ASSERT(crc32c(all.subspan(cut), crc32c(all.first(cut))) == crc32c(all));
  }));
}

std::vector<std::byte> make_frame(const FrameHeader& header, std::size_t body) {
  std::vector<std::byte> datagram(kFrameOverhead + body);
  for (std::size_t i = 0; i < body; ++i) datagram[kHeaderBytes + i] = static_cast<std::byte>(i * 7);
  finish_frame(header, datagram);
  return datagram;
}

TEST(Frame, LayoutIsTheDocumentedOne) {
  FrameHeader header;
  header.type = FrameType::data;
  header.session = 0x1122334455667788;
  header.sequence = 0xA0B0C0D0;
  header.timestamp = 0x01020304;
  const auto datagram = make_frame(header, 5);
  const std::uint8_t expected[] = {'F',  'T',  1,    6,    5,    0,    0,    0,    0x88, 0x77,
                                   0x66, 0x55, 0x44, 0x33, 0x22, 0x11, 0xD0, 0xC0, 0xB0, 0xA0,
                                   0x04, 0x03, 0x02, 0x01, 0,    7,    14,   21,   28};
  ASSERT_EQ(datagram.size(), sizeof expected + 4);
  EXPECT_EQ(std::memcmp(datagram.data(), expected, sizeof expected), 0);
  std::uint32_t crc;
  std::memcpy(&crc, datagram.data() + sizeof expected, sizeof crc);
  EXPECT_EQ(crc, crc32c(std::span(datagram).first(sizeof expected)));
}

TEST(Frame, ComesBack) {
  EXPECT_TRUE(rc::check(
      "frame", [](std::uint64_t session, std::uint32_t sequence, std::uint32_t timestamp) {
        FrameHeader header;
        header.type = static_cast<FrameType>(*rc::gen::inRange<int>(1, kLastFrameType + 1));
        header.session = session;
        header.sequence = sequence;
        header.timestamp = timestamp;
        const std::size_t size =
            *rc::gen::elementOf(std::vector<std::size_t>{0, 1, 7, 40, 1440, kMostBodyBytes});
        const auto datagram = make_frame(header, size);
        Frame frame;
        RC_ASSERT(parse_frame(datagram, frame) == FrameFault::none);
        RC_ASSERT(frame.header.type == header.type);
        RC_ASSERT(frame.header.session == session);
        RC_ASSERT(frame.header.sequence == sequence);
        RC_ASSERT(frame.header.timestamp == timestamp);
        RC_ASSERT(frame.body.size() == size);
        RC_ASSERT(frame.body.data() == datagram.data() + kHeaderBytes);
      }));
}

TEST(Frame, EveryFlippedBitIsSeen) {
  const auto good = make_frame({FrameType::ack, 42, 7, 9}, 12);
  Frame frame;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto bad = good;
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    EXPECT_NE(parse_frame(bad, frame), FrameFault::none) << bit;
  }
}

TEST(Frame, EveryOtherLengthIsSeen) {
  const auto good = make_frame({FrameType::ack, 42, 7, 9}, 12);
  Frame frame;
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_EQ(parse_frame(std::span(good).first(size), frame), FrameFault::length) << size;
  }
  auto longer = good;
  longer.push_back(std::byte{0});
  EXPECT_EQ(parse_frame(longer, frame), FrameFault::length);
  EXPECT_EQ(parse_frame(std::vector<std::byte>(70'000), frame), FrameFault::length);
}

TEST(Frame, UnknownTypesAndVersionsAreSeen) {
  Frame frame;
  for (const int type : {0, kLastFrameType + 1, 255}) {
    FrameHeader header;
    header.type = static_cast<FrameType>(type);
    EXPECT_EQ(parse_frame(make_frame(header, 4), frame), FrameFault::type) << type;
  }
  auto other = make_frame({}, 4);
  other[2] = std::byte{2};
  EXPECT_EQ(parse_frame(other, frame), FrameFault::version);
  other[0] = std::byte{'G'};
  EXPECT_EQ(parse_frame(other, frame), FrameFault::magic);
}

}  // namespace
}  // namespace fasttree::device
