// SPDX-License-Identifier: Apache-2.0
// How many frames may be under way at once, which is what the network is thought to hold: twice as
// many every round trip until frames get lost, and from there on one more a round trip.
#pragma once

#include <algorithm>

#include "device/link/messages.h"

namespace fasttree::device {

inline constexpr double kFirstFlight = 32;
inline constexpr double kLeastFlight = 16;

class Flight {
 public:
  double frames() const { return frames_; }

  void arrived(double frames) {
    frames_ += frames_ < threshold_ ? frames : frames / frames_;
    frames_ = std::min(frames_, static_cast<double>(kMostWindow));
  }

  /// Some of those that were under way together got lost.
  void some_lost() { frames_ = threshold_ = std::max(frames_ * 0.7, kLeastFlight); }

  /// Nothing is heard any more.
  void all_lost() {
    before_frames_ = frames_;
    before_threshold_ = threshold_;
    threshold_ = std::max(frames_ / 2, 2 * kLeastFlight);
    frames_ = kLeastFlight;
  }
  /// They were only late.
  void none_lost() {
    frames_ = std::max(frames_, before_frames_);
    threshold_ = std::max(threshold_, before_threshold_);
  }

 private:
  double frames_ = kFirstFlight;
  double threshold_ = kMostWindow;
  double before_frames_ = 0, before_threshold_ = 0;
};

}  // namespace fasttree::device
