// SPDX-License-Identifier: Apache-2.0
// What both ends of a session do with a datagram first, and with timers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "device/link/counts.h"
#include "device/link/frame.h"

namespace fasttree::device {

/// Whether the datagram is a frame; counts it, or why it is none.
inline bool admit(std::span<const std::byte> datagram, Frame& frame, LinkCounts& counts) {
  switch (parse_frame(datagram, frame)) {
    case FrameFault::none:
      ++counts.frames_received;
      return true;
    case FrameFault::length:
      ++counts.bad_length;
      return false;
    case FrameFault::magic:
    case FrameFault::version:
    case FrameFault::checksum:
      ++counts.bad_checksum;
      return false;
    case FrameFault::type:
      ++counts.bad_type;
      return false;
  }
  return false;
}

/// When something that is repeated until it is answered goes out: at once, and then after waits
/// that double up to a limit.
class Repeat {
 public:
  void start(Micros now, Micros first_wait, Micros most_wait) {
    due_ = now;
    wait_ = first_wait;
    most_ = most_wait;
    times_ = 0;
  }
  void stop() { due_ = kNever; }
  /// Once more, now.
  void hurry(Micros now) { due_ = std::min(due_, now); }
  bool due(Micros now) const { return now >= due_; }
  void done(Micros now) {
    due_ = now + wait_;
    wait_ = std::min(2 * wait_, most_);
    ++times_;
  }
  Micros next() const { return due_; }
  std::uint32_t times() const { return times_; }

 private:
  Micros due_ = kNever;
  Micros wait_ = 0;
  Micros most_ = 0;
  std::uint32_t times_ = 0;
};

}  // namespace fasttree::device
