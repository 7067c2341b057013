// SPDX-License-Identifier: Apache-2.0
// The sending end of a stream: data frames within the window, again where they were lost.
//
// A frame is taken for lost when one that was sent later has come and it has not, a round trip and
// a bit after it was sent; or when the timer runs out, unless an answer then shows that it was only
// late. Before the timer runs out one frame is sent again: the answer to it may have got lost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "device/link/byte_source.h"
#include "device/link/counts.h"
#include "device/link/flight.h"
#include "device/link/frame.h"
#include "device/link/messages.h"
#include "device/link/outbox.h"
#include "device/link/round_trip.h"

namespace fasttree::device {

inline constexpr std::uint32_t kMostTries = 16;  ///< of a frame

class Sender {
 public:
  /// `source` has to outlive the sender. Sends nothing before `limit` allows it (an ack does too).
  /// Timers never wait longer than a quarter of `silence`, after which the session would end.
  Sender(const ByteSource& source, std::uint32_t payload, std::uint32_t limit, Micros silence);

  /// False for an ack that cannot be.
  bool on_ack(const Frame& frame, Micros now);

  /// A round trip that was measured before the stream began.
  void know_round_trip(Micros time) { round_trip_.sample(time); }

  /// Writes what is due. True where more is due than the outbox had room for.
  bool poll(std::uint64_t session, const Peer& peer, Micros now, Outbox& out, LinkCounts& counts);
  Micros next_event() const;

  bool complete() const { return base_ == frames_; }
  bool failed() const { return failed_; }  ///< a frame went unanswered too often
  double fraction() const { return frames_ == 0 ? 1.0 : static_cast<double>(base_) / frames_; }

 private:
  enum class State : std::uint8_t { unsent, flying, lost, arrived };
  struct Slot {
    std::uint64_t order = 0;  ///< of its last transmission, among all
    Micros sent = 0;
    std::uint8_t tries = 0;
    State state = State::unsent;
  };

  Slot& slot(std::uint32_t sequence) { return slots_[sequence % kMostWindow]; }
  void arrive(std::uint32_t sequence, std::uint32_t echo);
  void lose(std::uint32_t sequence);
  void lose_overtaken(Micros now);
  void time_out(Micros now, LinkCounts& counts);
  void probe(Micros now);
  void undo_time_out(const Frame& frame);
  void set_timers(Micros now);
  Micros timeout() const;
  bool may_send_new() const;
  void send(std::uint32_t sequence, std::uint64_t session, const Peer& peer, Micros now,
            Outbox& out, LinkCounts& counts);

  const ByteSource& source_;
  std::uint64_t bytes_;
  std::uint32_t payload_;
  std::uint32_t frames_;
  Micros most_wait_;
  std::uint32_t base_ = 0;       ///< first frame that has not arrived
  std::uint32_t next_ = 0;       ///< first that was never sent
  std::uint32_t limit_;          ///< first that the receiver does not take
  std::uint32_t lost_ = 0;       ///< how many are
  std::uint32_t lost_from_ = 0;  ///< none is before
  std::uint32_t flying_ = 0;
  std::uint64_t sent_ = 0;            ///< transmissions
  std::uint64_t newest_arrived_ = 0;  ///< the last transmission known to have arrived
  std::uint32_t recovery_ = 0;        ///< losses before this frame have been answered
  Flight flight_;
  RoundTrip round_trip_;
  std::uint32_t backed_off_ = 0;
  Micros deadline_ = kNever;  ///< the timer
  Micros probe_ = kNever;     ///< when one frame is sent again
  std::uint32_t probes_ = 0;
  Micros timed_out_ = kNever;  ///< when the timer ran out, until it is known whether rightly
  Micros overtaken_ = kNever;  ///< when the next frame is taken for lost
  bool failed_ = false;
  std::array<Slot, kMostWindow> slots_{};
};

}  // namespace fasttree::device
