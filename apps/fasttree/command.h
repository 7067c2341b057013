// SPDX-License-Identifier: Apache-2.0
// What the subcommands share: how one is declared, what it is run with, how it fails.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fasttree/status.h"

namespace fasttree::app {

class Options;
class Output;
class Progress;

/// What the program's exit says. Part of what scripts may rely on.
enum ExitCode : int {
  kDone = 0,
  kCheckFailed = 1,    ///< the check that was asked for did not pass
  kUsage = 2,          ///< wrong option or value
  kBadInput = 3,       ///< a file or a device cannot be read or written, or what is in it is wrong
  kResourceLimit = 4,  ///< memory or disk
  kCancelled = 130,    ///< Ctrl-C, as shells count it
};

/// Thrown to end the program with a message and an exit code. Only here, above the library.
struct Failure {
  int exit_code = kUsage;
  std::string message;
};

int exit_code_of(StatusCode code);

/// Throws where the status is not ok.
void check(const Status& status);

template <typename T>
T take(Result<T> result) {
  check(result.status());
  return std::move(result).value();
}

/// Options that every subcommand has.
struct CommonOptions {
  std::string json;  ///< file, "-" for standard output, empty for none
  int threads = 0;   ///< 0: all
  bool quiet = false;
};

/// What a running subcommand may use.
struct Context {
  const CommonOptions& common;
  Output& output;
  Progress& progress;
  int threads;  ///< of the arena it runs in
};

/// A subcommand: declares its options, then runs with what they were set to. run() is called in the
/// task arena of --threads and returns an exit code.
class Command {
 public:
  virtual ~Command() = default;
  virtual const char* name() const = 0;
  virtual const char* summary() const = 0;  ///< one line
  virtual const char* details() const = 0;  ///< what --help says below the options, with an example
  virtual void declare(Options& options) = 0;
  virtual int run(Context& context) = 0;
};

std::unique_ptr<Command> make_info_command();
std::unique_ptr<Command> make_build_command();
std::unique_ptr<Command> make_verify_command();
std::unique_ptr<Command> make_render_command();
std::unique_ptr<Command> make_compare_command();
std::unique_ptr<Command> make_animate_command();
std::unique_ptr<Command> make_view_command();
std::unique_ptr<Command> make_memory_command();
std::unique_ptr<Command> make_simulate_command();
std::unique_ptr<Command> make_diff_command();
std::unique_ptr<Command> make_explore_command();
std::unique_ptr<Command> make_reproduce_command();
std::unique_ptr<Command> make_serve_command();

}  // namespace fasttree::app
