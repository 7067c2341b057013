// SPDX-License-Identifier: Apache-2.0
#include "device/link/receiver.h"

#include <algorithm>
#include <cstring>

#include "device/link/wire.h"

namespace fasttree::device {

std::uint64_t frame_count(std::uint64_t bytes, std::uint32_t payload) {
  return bytes / payload + (bytes % payload != 0 ? 1 : 0);
}

Receiver::Receiver(std::span<std::byte> to, std::uint32_t payload, std::uint32_t window)
    : to_(to),
      payload_(payload),
      window_(std::min(window, kMostWindow)),
      frames_(static_cast<std::uint32_t>(frame_count(to.size(), payload))) {}

bool Receiver::bit(std::uint32_t sequence) const {
  const std::uint32_t at = sequence % kMostWindow;
  return (bits_[at / 32] >> (at % 32) & 1) != 0;
}

void Receiver::on_data(const Frame& frame, LinkCounts& counts) {
  const std::uint32_t sequence = frame.header.sequence;
  if (sequence >= frames_ || (sequence >= next_ && sequence - next_ >= window_)) {
    ++counts.out_of_window;
    return;
  }
  const std::size_t offset = std::size_t{sequence} * payload_;
  if (frame.body.size() != std::min<std::size_t>(payload_, to_.size() - offset)) {
    ++counts.bad_length;
    return;
  }
  // Whatever it is, the sender seems not to know that it came.
  owes_ack_ = true;
  echo_ = frame.header.timestamp;
  if (sequence < next_ || (sequence < end_ && bit(sequence))) {
    ++counts.duplicates;
    return;
  }
  std::memcpy(to_.data() + offset, frame.body.data(), frame.body.size());
  bytes_received_ += frame.body.size();
  counts.data_bytes_received += frame.body.size();
  const auto word = [&](std::uint32_t s) -> std::uint32_t& { return bits_[s % kMostWindow / 32]; };
  word(sequence) |= 1u << (sequence % 32);
  end_ = std::max(end_, sequence + 1);
  while (next_ < end_ && bit(next_)) {
    word(next_) &= ~(1u << (next_ % 32));
    ++next_;
  }
}

void Receiver::write_ack(std::uint64_t session, const Peer& peer, Outbox& out) {
  const std::uint32_t words = (end_ - next_ + 31) / 32;
  const std::size_t bytes = kLeastAckBytes + 4 * std::size_t{words};
  const Body body = out.body(bytes);
  std::memset(body.data(), 0, bytes);
  put(body, 0, next_ + window_);
  for (std::uint32_t s = next_; s < end_; ++s) {
    if (!bit(s)) continue;
    const std::uint32_t i = s - next_;
    body[kLeastAckBytes + i / 8] |= std::byte{1} << (i % 8);
  }
  FrameHeader header;
  header.type = FrameType::ack;
  header.session = session;
  header.sequence = next_;
  header.timestamp = echo_;
  out.commit(header, bytes, peer);
  owes_ack_ = false;
}

}  // namespace fasttree::device
