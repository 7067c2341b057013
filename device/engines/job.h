// SPDX-License-Identifier: Apache-2.0
// A piece of work in a thread of its own, with progress and a way to stop it.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "device/link/messages.h"
#include "fasttree/build.h"
#include "fasttree/status.h"

namespace fasttree::device {

class Job {
 public:
  Job() = default;
  ~Job();  ///< cancels and waits
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// Not while one runs. `work` calls the callback now and then, and ends soon where that says
  /// false. `ended` is called after the work, from its thread.
  void start(std::function<Status(const ProgressCallback&)> work, std::function<void()> ended);

  bool runs() const;
  /// Nothing while it runs; else how it ended, and it has ended in every respect.
  std::optional<Status> wait_for(std::chrono::milliseconds time);
  void cancel() { cancelled_ = true; }
  const std::atomic<bool>& cancelled() const { return cancelled_; }
  BuildProgress progress() const;
  void set_progress(BuildProgress progress);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;
  bool runs_ = false;
  Status status_;
  BuildProgress progress_;
  std::atomic<bool> cancelled_{false};
};

}  // namespace fasttree::device
