// SPDX-License-Identifier: Apache-2.0
#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <utility>

#include "command.h"

namespace fasttree::app {
namespace {

// A signal handler can reach nothing but a global; lock-free, so that it may.
std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void on_interrupt(int) {
  interrupted.store(true, std::memory_order_relaxed);
}

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigemptyset(&action.sa_mask);
  // The second signal finds the default again and kills.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
}

bool cancelled() {
  return interrupted.load(std::memory_order_relaxed);
}

void stop_if_cancelled() {
  if (cancelled()) throw Failure{kCancelled, "cancelled"};
}

Progress::Progress(bool wanted)
    : draws_(wanted && isatty(STDERR_FILENO) == 1),
      // Work that is done in a moment needs no bar.
      next_(std::chrono::steady_clock::now() + std::chrono::milliseconds(300)) {}

ProgressCallback Progress::callback(std::string what) {
  return [this, what = std::move(what)](const char* stage, double fraction) {
    return step(what, stage, fraction);
  };
}

bool Progress::step(const std::string& what, const char* stage, double fraction) {
  if (cancelled()) return false;
  if (!draws_) return true;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return true;
  next_ = now + std::chrono::milliseconds(100);
  constexpr int kWidth = 30;
  const double part = std::clamp(fraction, 0.0, 1.0);
  const int filled = static_cast<int>(std::lround(part * kWidth));
  const std::string text = fmt::format("\r\x1b[K[{:#<{}}{:.<{}}] {:3.0f} %  {} {}", "", filled, "",
                                       kWidth - filled, part * 100, what, stage);
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
  drawn_ = true;
  return true;
}

void Progress::clear() {
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace fasttree::app
