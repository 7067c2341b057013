// SPDX-License-Identifier: Apache-2.0
// The receiving end of a stream: puts each data frame in its place and says which have come.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "device/link/counts.h"
#include "device/link/frame.h"
#include "device/link/messages.h"
#include "device/link/outbox.h"

namespace fasttree::device {

// An ack: u32 the first frame that will not be taken, then words of 32 bits, bit i of all of them
// being frame sequence + i. Frames before `sequence` have all come. Zero words at the end are left
// out.
inline constexpr std::size_t kLeastAckBytes = 4;
inline constexpr std::size_t kMostAckBytes = kLeastAckBytes + kMostWindow / 8;

class Receiver {
 public:
  /// Fills `to`. All frames but the last have `payload` bytes.
  Receiver(std::span<std::byte> to, std::uint32_t payload, std::uint32_t window);

  /// Counts what it does not want.
  void on_data(const Frame& frame, LinkCounts& counts);

  bool complete() const { return next_ == frames_; }
  std::uint64_t bytes_received() const { return bytes_received_; }

  bool owes_ack() const { return owes_ack_; }
  void owe_ack() { owes_ack_ = true; }
  /// The ack answers something else than data, of this timestamp.
  void owe_ack(std::uint32_t timestamp) {
    owes_ack_ = true;
    echo_ = timestamp;
  }
  /// Only where the outbox has room for the longest ack.
  void write_ack(std::uint64_t session, const Peer& peer, Outbox& out);

 private:
  bool bit(std::uint32_t sequence) const;

  std::span<std::byte> to_;
  std::uint32_t payload_;
  std::uint32_t window_;
  std::uint32_t frames_;
  std::uint32_t next_ = 0;  ///< first frame that has not come
  std::uint32_t end_ = 0;   ///< one past the last that has
  std::array<std::uint32_t, kMostWindow / 32>
      bits_{};  ///< a ring: which of [next_, end_) have come
  std::uint32_t echo_ = 0;
  std::uint64_t bytes_received_ = 0;
  bool owes_ack_ = false;
};

/// Frames of a stream.
std::uint64_t frame_count(std::uint64_t bytes, std::uint32_t payload);
/// Largest number of them: sequence numbers do not wrap.
inline constexpr std::uint64_t kMostFrames = std::uint64_t{1} << 31;

}  // namespace fasttree::device
