// SPDX-License-Identifier: Apache-2.0
// How long an answer takes, learned from answers (as RFC 6298 does), and how long to wait for one.
#pragma once

#include <algorithm>

#include "device/link/counts.h"

namespace fasttree::device {

inline constexpr Micros kFirstTimeout = 100'000;
inline constexpr Micros kLeastTimeout = 10'000;
inline constexpr Micros kMostTimeout = 1'000'000;

class RoundTrip {
 public:
  void sample(Micros time) {
    time = std::min(time, kMostTimeout);
    if (smooth_ == 0) {
      smooth_ = std::max<Micros>(time, 1);
      variation_ = time / 2;
      return;
    }
    const Micros off = time > smooth_ ? time - smooth_ : smooth_ - time;
    variation_ = (3 * variation_ + off) / 4;
    smooth_ = std::max<Micros>((7 * smooth_ + time) / 8, 1);
  }

  /// After this a frame that others have overtaken is taken for lost.
  Micros patience() const { return smooth_ + std::max(smooth_ / 4, variation_); }

  /// After this without any answer one frame is sent again, to bring one about.
  Micros probe() const {
    return smooth_ == 0 ? kFirstTimeout : std::max<Micros>(2 * smooth_ + 2 * variation_, 1000);
  }

  /// After this without any answer all that is under way is taken for lost.
  Micros timeout() const {
    if (smooth_ == 0) return kFirstTimeout;
    return std::clamp(smooth_ + 4 * variation_, kLeastTimeout, kMostTimeout);
  }

 private:
  Micros smooth_ = 0;  ///< 0: nothing measured
  Micros variation_ = 0;
};

}  // namespace fasttree::device
