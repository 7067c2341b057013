// SPDX-License-Identifier: Apache-2.0
// Named, timed regions of a build, which are also where progress is told and cancelling noticed.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "fasttree/build.h"
#include "fasttree/status.h"

namespace fasttree {

/// Runs stages one after the other. Times are appended to `times`; the callback is asked before
/// each stage, and by report() inside one.
class StageClock {
 public:
  StageClock(const ProgressCallback& progress, std::vector<StageTime>& times)
      : progress_(progress), times_(times) {}

  /// Runs `work`, which covers the whole build's progress from `begin` to `end`. Does nothing once
  /// the caller has cancelled.
  template <typename Work>
  void stage(const char* name, double begin, double end, Work&& work) {
    if (cancelled_) return;
    name_ = name;
    begin_ = begin;
    end_ = end;
    if (!report(0.0)) return;
    const auto start = std::chrono::steady_clock::now();
    work();
    const auto stop = std::chrono::steady_clock::now();
    times_.push_back({name, std::chrono::duration<double, std::milli>(stop - start).count()});
  }

  /// Tells how far the running stage is, 0 to 1. False when the work should stop.
  bool report(double fraction) {
    if (!cancelled_ && progress_ && !progress_(name_, begin_ + (end_ - begin_) * fraction)) {
      cancelled_ = true;
    }
    return !cancelled_;
  }

  bool cancelled() const { return cancelled_; }

  Status cancelled_status() const {
    return {StatusCode::cancelled, std::string("cancelled during ") + name_};
  }

 private:
  const ProgressCallback& progress_;
  std::vector<StageTime>& times_;
  const char* name_ = "";
  double begin_ = 0;
  double end_ = 1;
  bool cancelled_ = false;
};

}  // namespace fasttree
