// SPDX-License-Identifier: Apache-2.0
#include "device/link/sender.h"

#include <algorithm>

#include "device/link/receiver.h"
#include "device/link/wire.h"

namespace fasttree::device {

Sender::Sender(const ByteSource& source, std::uint32_t payload, std::uint32_t limit, Micros silence)
    : source_(source),
      bytes_(source.size()),
      payload_(payload),
      frames_(static_cast<std::uint32_t>(frame_count(bytes_, payload))),
      most_wait_(std::min(silence / 4, kMostTimeout)),
      limit_(limit) {}

void Sender::arrive(std::uint32_t sequence, std::uint32_t echo) {
  Slot& s = slot(sequence);
  if (s.state == State::flying) --flying_;
  if (s.state == State::lost) --lost_;
  s.state = State::arrived;
  // An answer to something older is one to an earlier transmission, which has overtaken nobody.
  const auto since = static_cast<std::int32_t>(echo - static_cast<std::uint32_t>(s.sent));
  if (s.tries == 1 || since >= 0) newest_arrived_ = std::max(newest_arrived_, s.order);
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
      arrive(base_, frame.header.timestamp);
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
      arrive(s, frame.header.timestamp);
      ++arrived;
    }
  }
  limit_ = std::max(limit_, limit);
  lost_from_ = std::max(lost_from_, base_);
  if (arrived > 0) {
    if (timed_out_ != kNever) undo_time_out(frame);
    round_trip_.sample(static_cast<std::uint32_t>(now) - frame.header.timestamp);
    backed_off_ = 0;
    flight_.arrived(arrived);
  }
  lose_overtaken(now);
  if (arrived > 0) set_timers(now);
  return true;
}

void Sender::set_timers(Micros now) {
  const bool waits = flying_ + lost_ > 0;
  deadline_ = waits ? now + timeout() : kNever;
  probe_ = waits ? now + round_trip_.probe() : kNever;
  probes_ = 0;
}

// The first answer after the timer ran out: to something that was sent before?
void Sender::undo_time_out(const Frame& frame) {
  const auto before = static_cast<std::uint32_t>(timed_out_) - frame.header.timestamp;
  timed_out_ = kNever;
  if (static_cast<std::int32_t>(before) <= 0) return;
  flight_.none_lost();
  for (std::uint32_t s = base_; s < next_; ++s) {
    if (slot(s).state == State::lost) slot(s).state = State::flying;
  }
  flying_ += lost_;
  lost_ = 0;
}

// One frame goes out, however many are under way: a lost one, or else the oldest. Ever more rarely.
void Sender::probe(Micros now) {
  ++probes_;
  probe_ = now + (round_trip_.probe() << std::min(probes_, 10u));
  if (lost_ > 0) return;
  for (std::uint32_t s = base_; s < next_; ++s) {
    if (slot(s).state != State::flying) continue;
    if (slot(s).sent < now) lose(s);
    return;
  }
}

void Sender::lose_overtaken(Micros now) {
  overtaken_ = kNever;
  const Micros patience = round_trip_.patience();
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
    flight_.some_lost();
  }
}

Micros Sender::timeout() const {
  return std::min(round_trip_.timeout() << std::min(backed_off_, 10u), most_wait_);
}

void Sender::time_out(Micros now, LinkCounts& counts) {
  ++counts.timeouts;
  ++backed_off_;
  for (std::uint32_t s = base_; s < next_; ++s) {
    if (slot(s).state == State::flying) lose(s);
  }
  recovery_ = next_;
  if (backed_off_ == 1) flight_.all_lost();
  timed_out_ = now;
  probe_ = kNever;
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
  bool probes = now >= probe_;
  if (probes) probe(now);
  while ((probes || flying_ < flight_.frames()) && (lost_ > 0 || may_send_new())) {
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
    probes = false;
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
  if (deadline_ == kNever) set_timers(now);
}

Micros Sender::next_event() const {
  if (failed_) return 0;
  if (flying_ < flight_.frames() && (lost_ > 0 || may_send_new())) return 0;
  return std::min({deadline_, overtaken_, probe_});
}

}  // namespace fasttree::device
