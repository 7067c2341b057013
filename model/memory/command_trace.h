// SPDX-License-Identifier: Apache-2.0
// A command trace as text: a line a command, "clock channel command bank row column".
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/memory/dram_command.h"

namespace fasttree::model {

std::string to_line(const DramCommand& command);

/// Hands the text on in pieces of some 64 KB, so that a trace of any length takes no more memory.
class CommandTrace final : public CommandObserver {
 public:
  explicit CommandTrace(std::function<void(std::string_view)> sink) : sink_(std::move(sink)) {
    buffer_ = "# clock channel command bank row column\n";
  }
  void on_command(const DramCommand& command) override;
  /// Hands on the rest.
  void finish();

 private:
  std::function<void(std::string_view)> sink_;
  std::string buffer_;
};

/// Keeps the commands themselves, up to a number.
class CommandRecorder final : public CommandObserver {
 public:
  explicit CommandRecorder(std::size_t limit) : limit_(limit) {}
  void on_command(const DramCommand& command) override {
    if (commands_.size() < limit_) commands_.push_back(command);
  }
  const std::vector<DramCommand>& commands() const { return commands_; }

 private:
  std::size_t limit_;
  std::vector<DramCommand> commands_;
};

/// Shows each command to several observers.
class CommandFanOut final : public CommandObserver {
 public:
  void add(CommandObserver* observer) { observers_.push_back(observer); }
  bool empty() const { return observers_.empty(); }
  void on_command(const DramCommand& command) override {
    for (CommandObserver* observer : observers_) observer->on_command(command);
  }

 private:
  std::vector<CommandObserver*> observers_;
};

}  // namespace fasttree::model
