// SPDX-License-Identifier: Apache-2.0
// A progress bar on the terminal, and Ctrl-C.
#pragma once

#include <chrono>
#include <string>

#include "fasttree/build.h"

namespace fasttree::app {

/// From now on the first Ctrl-C makes cancelled() true; the second one ends the program.
void catch_interrupts();
bool cancelled();

/// Throws Failure (130) after a Ctrl-C.
void stop_if_cancelled();

/// Draws on standard error, and only where that is a terminal and `wanted`. The bar is erased when
/// a piece of work is done, so that it never mixes with what is printed.
class Progress {
 public:
  explicit Progress(bool wanted);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// For the library's calls; refers to this object. `what` stands before the stage's name.
  ProgressCallback callback(std::string what);

  /// Erases the bar.
  void clear();

 private:
  bool step(const std::string& what, const char* stage, double fraction);

  bool draws_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace fasttree::app
