// SPDX-License-Identifier: Apache-2.0
// Frames on their way out: one piece of memory, frame behind frame, so that equal ones can leave
// together. And where they go to.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "device/link/frame.h"

namespace fasttree::device {

/// Where a datagram comes from or goes to: an address of IPv6, or of IPv4 mapped into it. Means
/// nothing to the sessions but that it can be compared.
struct Peer {
  std::array<std::uint8_t, 16> address{};
  std::uint32_t scope = 0;
  std::uint16_t port = 0;
  friend bool operator==(const Peer&, const Peer&) = default;
};

class Outbox {
 public:
  struct Entry {
    std::size_t offset = 0;
    std::size_t bytes = 0;
    Peer peer;
  };

  static constexpr std::size_t kCapacity = std::size_t{512} << 10;

  Outbox() : memory_(std::make_unique_for_overwrite<std::byte[]>(kCapacity)) {}

  bool has_room(std::size_t body_bytes) const {
    return used_ + kFrameOverhead + body_bytes <= kCapacity;
  }

  /// Where the next frame's body goes. Only where it has room.
  std::span<std::byte> body(std::size_t body_bytes) {
    return {memory_.get() + used_ + kHeaderBytes, body_bytes};
  }

  /// Makes a frame of the body that was written.
  void commit(const FrameHeader& header, std::size_t body_bytes, const Peer& peer) {
    const std::size_t bytes = kFrameOverhead + body_bytes;
    finish_frame(header, {memory_.get() + used_, bytes});
    entries_.push_back({used_, bytes, peer});
    used_ += bytes;
  }

  /// A datagram as it is, whatever it is. False where there is no room.
  bool add(std::span<const std::byte> datagram, const Peer& peer) {
    if (used_ + datagram.size() > kCapacity) return false;
    std::copy(datagram.begin(), datagram.end(), memory_.get() + used_);
    entries_.push_back({used_, datagram.size(), peer});
    used_ += datagram.size();
    return true;
  }

  std::span<const Entry> entries() const { return entries_; }
  std::span<const std::byte> datagram(const Entry& entry) const {
    return {memory_.get() + entry.offset, entry.bytes};
  }
  bool empty() const { return entries_.empty(); }
  void clear() {
    entries_.clear();
    used_ = 0;
  }

 private:
  std::unique_ptr<std::byte[]> memory_;
  std::size_t used_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace fasttree::device
