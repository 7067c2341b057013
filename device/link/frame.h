// SPDX-License-Identifier: Apache-2.0
// The frame, which is what a UDP datagram carries: 24 bytes of header, a body, a checksum. Layout
// by byte: docs/protocol.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace fasttree::device {

enum class FrameType : std::uint8_t {
  describe = 1,     ///< client: who are you?
  description = 2,  ///< server: this
  hello = 3,        ///< client: a session for a scene of this size, please
  accept = 4,       ///< server: yes
  refuse = 5,       ///< server: no, because
  data = 6,         ///< a piece of the stream in this direction
  ack = 7,          ///< what has come of the stream in the other one
  progress = 8,     ///< server: how far the build is
  alive = 9,        ///< client: the answer to progress
  offer = 10,       ///< server: the result, so many bytes
  fault = 11,       ///< server: no result, because
  close = 12,       ///< client: the session is over
  reset = 13,       ///< server: there is no such session
};
inline constexpr std::uint8_t kLastFrameType = 13;

inline constexpr std::size_t kHeaderBytes = 24;
inline constexpr std::size_t kChecksumBytes = 4;
inline constexpr std::size_t kFrameOverhead = kHeaderBytes + kChecksumBytes;
inline constexpr std::size_t kMostDatagramBytes = 65507;  ///< of UDP over IPv4
inline constexpr std::size_t kMostBodyBytes = kMostDatagramBytes - kFrameOverhead;
inline constexpr std::uint8_t kProtocolVersion = 1;

struct FrameHeader {
  FrameType type = FrameType::reset;
  std::uint64_t session = 0;
  std::uint32_t sequence = 0;
  std::uint32_t timestamp = 0;  ///< the sender's microseconds; in an ack those that it answers
};

struct Frame {
  FrameHeader header;
  std::span<const std::byte> body;
};

/// Why a datagram is no frame, in the order in which this is looked for.
enum class FrameFault : std::uint8_t { none, length, magic, version, checksum, type };

/// Looks at all of a datagram. The frame's body points into it.
FrameFault parse_frame(std::span<const std::byte> datagram, Frame& frame);

/// Writes header and checksum around the body, which is in its place, `kHeaderBytes` from the
/// beginning; `datagram` is the whole frame.
void finish_frame(const FrameHeader& header, std::span<std::byte> datagram);

}  // namespace fasttree::device
