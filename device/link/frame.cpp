// SPDX-License-Identifier: Apache-2.0
#include "device/link/frame.h"

#include "device/link/crc32c.h"
#include "device/link/wire.h"

namespace fasttree::device {
namespace {

constexpr std::uint16_t kMagic = 0x5446;  // "FT"
constexpr std::size_t kVersionAt = 2;
constexpr std::size_t kTypeAt = 3;
constexpr std::size_t kLengthAt = 4;
constexpr std::size_t kReservedAt = 6;
constexpr std::size_t kSessionAt = 8;
constexpr std::size_t kSequenceAt = 16;
constexpr std::size_t kTimestampAt = 20;

}  // namespace

FrameFault parse_frame(std::span<const std::byte> datagram, Frame& frame) {
  if (datagram.size() < kFrameOverhead || datagram.size() > kMostDatagramBytes) {
    return FrameFault::length;
  }
  if (get<std::uint16_t>(datagram, 0) != kMagic) return FrameFault::magic;
  if (get<std::uint8_t>(datagram, kVersionAt) != kProtocolVersion) return FrameFault::version;
  const std::size_t body = get<std::uint16_t>(datagram, kLengthAt);
  if (body + kFrameOverhead != datagram.size()) return FrameFault::length;
  const std::size_t covered = kHeaderBytes + body;
  if (crc32c(datagram.first(covered)) != get<std::uint32_t>(datagram, covered)) {
    return FrameFault::checksum;
  }
  const auto type = get<std::uint8_t>(datagram, kTypeAt);
  if (type == 0 || type > kLastFrameType) return FrameFault::type;
  frame.header.type = static_cast<FrameType>(type);
  frame.header.session = get<std::uint64_t>(datagram, kSessionAt);
  frame.header.sequence = get<std::uint32_t>(datagram, kSequenceAt);
  frame.header.timestamp = get<std::uint32_t>(datagram, kTimestampAt);
  frame.body = datagram.subspan(kHeaderBytes, body);
  return FrameFault::none;
}

void finish_frame(const FrameHeader& header, std::span<std::byte> datagram) {
  const std::size_t covered = datagram.size() - kChecksumBytes;
  put(datagram, 0, kMagic);
  put(datagram, kVersionAt, kProtocolVersion);
  put(datagram, kTypeAt, static_cast<std::uint8_t>(header.type));
  put(datagram, kLengthAt, static_cast<std::uint16_t>(covered - kHeaderBytes));
  put(datagram, kReservedAt, std::uint16_t{0});
  put(datagram, kSessionAt, header.session);
  put(datagram, kSequenceAt, header.sequence);
  put(datagram, kTimestampAt, header.timestamp);
  put(datagram, covered, crc32c(datagram.first(covered)));
}

}  // namespace fasttree::device
