// SPDX-License-Identifier: Apache-2.0
#include "device/link/sender.h"

#include <algorithm>
#include <cmath>

#include "device/link/receiver.h"
#include "device/link/wire.h"

namespace fasttree::device {

Sender::Sender(const ByteSource& source, std::uint32_t payload, std::uint32_t limit, Micros silence)
    : source_(source),
      bytes_(source.size()),
      payload_(payload),
      frames_(static_cast<std::uint32_t>(frame_count(bytes_, payload))),
      most_wait_(std::min(silence / 4, kMostRetransmission)),
      limit_(limit) {}

void Sender::arrive(std::uint32_t sequence) {
  Slot& s = slot(sequence);
  if (s.state == State::flying) --flying_;
  if (s.state == State::lost) --lost_;
  s.state = State::arrived;
  newest_arrived_ = std::max(newest_arrived_, s.order);
}

void Sender::lose(std::uint32_t sequence) {
  slot(sequence).state = State::lost;
  --flying_;
  ++lost_;
  lost_from_ = std::min(lost_from_, sequence);
}

bool Sender::on_ack(const Frame& frame, Micros now) {
  const std::uint32_t sequence = frame.header.sequence;
  const std::size_t bytes = frame.body.size();
  if (bytes < kLeastAckBytes || bytes > kMostAckBytes || bytes % 4 != 0) return false;
  if (sequence > next_) return false;
  const auto limit = get<std::uint32_t>(frame.body, 0);
  if (limit < sequence || limit - sequence > kMostWindow) return false;
  if (sequence < base_) return true;  // overtaken by a newer one

  std::uint32_t arrived = 0;
  for (; base_ < sequence; ++base_) {
    if (slot(base_).state != State::arrived) {
      arrive(base_);
      ++arrived;
    }
    slot(base_) = Slot();
  }
  for (std::size_t word = 0; word < (bytes - kLeastAckBytes) / 4; ++word) {
    auto bits = get<std::uint32_t>(frame.body, kLeastAckBytes + 4 * word);
    // Frame `sequence` itself has not come. Were it so, no timer would bring an answer about.
    if (word == 0 && (bits & 1) != 0) return false;
    for (std::uint32_t s = sequence + 32 * static_cast<std::uint32_t>(word); bits != 0;
         bits >>= 1, ++s) {
      if ((bits & 1) == 0) continue;
      if (s >= next_) return false;
      if (slot(s).state == State::arrived) continue;
      arrive(s);
      ++arrived;
    }
  }
  limit_ = std::max(limit_, limit);
  lost_from_ = std::max(lost_from_, base_);
  if (arrived > 0) {
    sample(static_cast<std::uint32_t>(now) - frame.header.timestamp);
    backed_off_ = 0;
    flight_ += slow_start_ ? arrived : arrived / flight_;
    flight_ = std::min(flight_, static_cast<double>(kMostWindow));
  }
  lose_overtaken(now);
  if (arrived > 0) deadline_ = flying_ + lost_ > 0 ? now + timeout() : kNever;
  return true;
}

void Sender::lose_overtaken(Micros now) {
  overtaken_ = kNever;
  const Micros patience = smooth_ + std::max(smooth_ / 4, variation_);
  for (std::uint32_t s = base_; s < next_; ++s) {
    const Slot& frame = slot(s);
    if (frame.state != State::flying || frame.order > newest_arrived_) continue;
    if (now < frame.sent + patience) {
      overtaken_ = std::min(overtaken_, frame.sent + patience);
      continue;
    }
    lose(s);
    if (s < recovery_) continue;
    // Once for all that were under way together.
    recovery_ = next_;
    slow_start_ = false;
    flight_ = std::max(flight_ * 0.7, kLeastFlight);
  }
}

void Sender::sample(Micros round_trip) {
  round_trip = std::min(round_trip, kMostRetransmission);
  if (smooth_ == 0) {
    smooth_ = std::max<Micros>(round_trip, 1);
    variation_ = round_trip / 2;
    return;
  }
  const Micros off = round_trip > smooth_ ? round_trip - smooth_ : smooth_ - round_trip;
  variation_ = (3 * variation_ + off) / 4;
  smooth_ = std::max<Micros>((7 * smooth_ + round_trip) / 8, 1);
}

Micros Sender::timeout() const {
  const Micros first = smooth_ == 0 ? kFirstTimeout : smooth_ + 4 * variation_;
  const Micros once = std::clamp(first, kLeastRetransmission, kMostRetransmission);
  return std::min(once << std::min(backed_off_, 10u), most_wait_);
}

void Sender::time_out(Micros now, LinkCounts& counts) {
  ++counts.timeouts;
  ++backed_off_;
  for (std::uint32_t s = base_; s < next_; ++s) {
    if (slot(s).state == State::flying) lose(s);
  }
  recovery_ = next_;
  slow_start_ = false;
  flight_ = kLeastFlight;
  deadline_ = now + timeout();
  overtaken_ = kNever;
}

bool Sender::may_send_new() const {
  return next_ < frames_ && next_ < limit_ && next_ - base_ < kMostWindow;
}

bool Sender::poll(std::uint64_t session, const Peer& peer, Micros now, Outbox& out,
                  LinkCounts& counts) {
  if (failed_) return false;
  if (now >= deadline_) time_out(now, counts);
  if (now >= overtaken_) lose_overtaken(now);
  while (flying_ < flight_ && (lost_ > 0 || may_send_new())) {
    if (!out.has_room(payload_)) return true;
    std::uint32_t sequence = next_;
    if (lost_ > 0) {
      while (slot(lost_from_).state != State::lost) ++lost_from_;
      sequence = lost_from_;
    }
    if (slot(sequence).tries >= kMostTries) {
      failed_ = true;
      return false;
    }
    send(sequence, session, peer, now, out, counts);
  }
  return false;
}

void Sender::send(std::uint32_t sequence, std::uint64_t session, const Peer& peer, Micros now,
                  Outbox& out, LinkCounts& counts) {
  Slot& s = slot(sequence);
  if (s.state == State::lost) {
    --lost_;
    ++counts.retransmitted;
  } else {
    ++next_;
  }
  s.state = State::flying;
  s.order = ++sent_;
  s.sent = now;
  ++s.tries;
  ++flying_;
  const std::uint64_t offset = std::uint64_t{sequence} * payload_;
  const auto bytes = static_cast<std::size_t>(std::min<std::uint64_t>(payload_, bytes_ - offset));
  source_.read(offset, out.body(bytes));
  FrameHeader header;
  header.type = FrameType::data;
  header.session = session;
  header.sequence = sequence;
  header.timestamp = static_cast<std::uint32_t>(now);
  out.commit(header, bytes, peer);
  counts.data_bytes_sent += bytes;
  if (deadline_ == kNever) deadline_ = now + timeout();
}

Micros Sender::next_event() const {
  if (failed_) return 0;
  if (flying_ < flight_ && (lost_ > 0 || may_send_new())) return 0;
  return std::min(deadline_, overtaken_);
}

}  // namespace fasttree::device
