// SPDX-License-Identifier: Apache-2.0
// What went over a link, and what was not let in.
#pragma once

#include <cstdint>

namespace fasttree::device {

/// Time of a clock that never goes back, in microseconds. The sessions are told it; they have none.
using Micros = std::uint64_t;
inline constexpr Micros kNever = ~Micros{0};

struct LinkCounts {
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_received = 0;  ///< good ones, whatever was in them
  std::uint64_t data_bytes_sent = 0;  ///< bodies of data frames, those sent again included
  std::uint64_t data_bytes_received = 0;
  std::uint64_t retransmitted = 0;  ///< data frames
  std::uint64_t timeouts = 0;       ///< times that a stream's timer ran out

  // Dropped.
  std::uint64_t bad_length = 0;     ///< no frame's, or not its type's
  std::uint64_t bad_checksum = 0;   ///< or no frame of this protocol at all
  std::uint64_t bad_type = 0;       ///< unknown, or the other side's
  std::uint64_t bad_content = 0;    ///< a value that cannot be
  std::uint64_t wrong_session = 0;  ///< of another session, or from another address
  std::uint64_t out_of_window = 0;
  std::uint64_t duplicates = 0;

  std::uint64_t dropped() const {
    return bad_length + bad_checksum + bad_type + bad_content + wrong_session + out_of_window +
           duplicates;
  }
  LinkCounts& operator+=(const LinkCounts& other);
};

}  // namespace fasttree::device
