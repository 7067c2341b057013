// SPDX-License-Identifier: Apache-2.0
// Judges a command trace by the device's rules alone. It shares nothing with the controller but the
// specification: the controller moves deadlines forward, this looks back at what was issued and
// measures distances, so that one's mistake is not the other's.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "model/memory/dram_command.h"
#include "model/memory/memory_config.h"

namespace fasttree::model {

struct CommandViolation {
  DramCommand command;
  std::string rule;  ///< "tRP", "tFAW", "row", "refresh", ...
  std::string text;  ///< in words, with clocks
};

class CommandChecker final : public CommandObserver {
 public:
  /// `controller` says how late a refresh may be; nothing else of it is looked at.
  CommandChecker(const DramSpec& spec, const ControllerConfig& controller);

  void on_command(const DramCommand& command) override;
  /// The run ends at this clock: refreshes that are missing count.
  void finish(std::uint64_t clock);

  std::uint64_t commands() const { return commands_; }
  std::uint64_t violation_count() const { return violation_count_; }
  /// The first of them, 100 at most.
  const std::vector<CommandViolation>& violations() const { return violations_; }

 private:
  static constexpr std::size_t kKinds = 6;

  enum class Scope : std::uint8_t { same_bank, other_bank, any };
  /// From one command to a later one, at least so many clocks.
  struct Distance {
    const char* name;
    Scope scope;
    std::uint64_t clocks;
  };
  struct Bank {
    bool open = false;
    std::uint32_t row = 0;
  };
  struct Channel {
    std::deque<DramCommand> recent;
    std::vector<Bank> banks;
    std::uint64_t refreshes = 0;
    std::uint64_t data_end = 0;  ///< of the last burst on the data bus
  };

  void distance(DramCommandKind from, DramCommandKind to, Scope scope, std::uint64_t clocks,
                const char* name);
  void check_distances(const Channel& channel, const DramCommand& command);
  void check_window(const Channel& channel, const DramCommand& command);
  void check_data_bus(Channel& channel, const DramCommand& command);
  void check_state(Channel& channel, const DramCommand& command);
  void check_refresh(const Channel& channel, const DramCommand& command);
  void report(const DramCommand& command, const char* rule, std::string text);

  DramSpec spec_;
  RefreshPolicy refresh_;
  std::uint64_t postpone_;
  std::array<std::vector<Distance>, kKinds * kKinds> distances_;
  std::uint64_t longest_ = 0;  ///< distance that any rule looks back
  std::vector<Channel> channels_;
  std::uint64_t commands_ = 0;
  std::uint64_t violation_count_ = 0;
  std::vector<CommandViolation> violations_;
};

}  // namespace fasttree::model
