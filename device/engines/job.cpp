// SPDX-License-Identifier: Apache-2.0
#include "device/engines/job.h"

#include <exception>
#include <new>
#include <utility>

namespace fasttree::device {

Job::~Job() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

void Job::start(std::function<Status(const ProgressCallback&)> work, std::function<void()> ended) {
  if (thread_.joinable()) thread_.join();
  cancelled_ = false;
  {
    const std::lock_guard lock(mutex_);
    runs_ = true;
    status_ = Status();
    progress_ = {"starting", 0};
  }
  thread_ = std::thread([this, work = std::move(work), ended = std::move(ended)] {
    Status status;
    try {
      status = work([this](const char* stage, double fraction) {
        set_progress({stage, fraction});
        return !cancelled_;
      });
    } catch (const std::bad_alloc&) {
      status = {StatusCode::resource_limit, "out of memory"};
    } catch (const std::exception& error) {
      status = {StatusCode::io_error, error.what()};
    }
    {
      const std::lock_guard lock(mutex_);
      runs_ = false;
      status_ = std::move(status);
    }
    changed_.notify_all();
    if (ended) ended();
  });
}

bool Job::runs() const {
  const std::lock_guard lock(mutex_);
  return runs_;
}

std::optional<Status> Job::wait_for(std::chrono::milliseconds time) {
  {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, time, [this] { return !runs_; })) return std::nullopt;
  }
  if (thread_.joinable()) thread_.join();
  return status_;
}

BuildProgress Job::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

void Job::set_progress(BuildProgress progress) {
  const std::lock_guard lock(mutex_);
  progress_ = std::move(progress);
}

}  // namespace fasttree::device
