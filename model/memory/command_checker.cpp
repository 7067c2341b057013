// SPDX-License-Identifier: Apache-2.0
#include "model/memory/command_checker.h"

#include <algorithm>

namespace fasttree::model {

namespace {

constexpr std::size_t kMaxReports = 100;

std::size_t number(DramCommandKind kind) {
  return static_cast<std::size_t>(kind);
}

}  // namespace

CommandChecker::CommandChecker(const DramSpec& spec, const ControllerConfig& controller)
    : spec_(spec),
      refresh_(controller.refresh),
      postpone_(controller.refresh_postpone),
      channels_(spec.channels) {
  for (Channel& channel : channels_) channel.banks.resize(spec.banks);
  using enum DramCommandKind;
  const std::uint64_t burst = spec.burst_length / 2;
  distance(activate, read, Scope::same_bank, spec.trcd, "tRCD");
  distance(activate, write, Scope::same_bank, spec.trcd, "tRCD");
  distance(activate, precharge, Scope::same_bank, spec.tras, "tRAS");
  distance(activate, activate, Scope::same_bank, spec.trc, "tRC");
  distance(activate, refresh_bank, Scope::same_bank, spec.trc, "tRC");
  distance(activate, refresh_all, Scope::any, spec.trc, "tRC");
  distance(activate, activate, Scope::other_bank, spec.trrd, "tRRD");
  distance(activate, refresh_bank, Scope::other_bank, spec.trrd, "tRRD");
  distance(refresh_bank, activate, Scope::other_bank, spec.trrd, "tRRD");
  distance(precharge, activate, Scope::same_bank, spec.trp, "tRP");
  distance(precharge, refresh_bank, Scope::same_bank, spec.trp, "tRP");
  distance(precharge, refresh_all, Scope::any, spec.trp, "tRP");
  distance(read, precharge, Scope::same_bank, spec.trtp, "tRTP");
  distance(write, precharge, Scope::same_bank, spec.cwl + burst + spec.twr, "tWR");
  distance(write, read, Scope::any, spec.cwl + burst + spec.twtr, "tWTR");
  distance(read, read, Scope::any, spec.tccd, "tCCD");
  distance(write, write, Scope::any, spec.tccd, "tCCD");
  distance(refresh_bank, activate, Scope::same_bank, spec.trfc_pb, "tRFCpb");
  distance(refresh_bank, refresh_bank, Scope::any, spec.trfc_pb, "tRFCpb");
  distance(refresh_all, activate, Scope::any, spec.trfc_ab, "tRFCab");
  distance(refresh_all, refresh_all, Scope::any, spec.trfc_ab, "tRFCab");
  longest_ = std::max<std::uint64_t>(longest_, spec.tfaw);
}

void CommandChecker::distance(DramCommandKind from, DramCommandKind to, Scope scope,
                              std::uint64_t clocks, const char* name) {
  distances_[number(from) * kKinds + number(to)].push_back({name, scope, clocks});
  longest_ = std::max(longest_, clocks);
}

void CommandChecker::report(const DramCommand& command, const char* rule, std::string text) {
  ++violation_count_;
  if (violations_.size() >= kMaxReports) return;
  text = "clock " + std::to_string(command.clock) + ", channel " + std::to_string(command.channel) +
         ", " + to_string(command.kind) + " of bank " + std::to_string(command.bank) + ": " + rule +
         ": " + text;
  violations_.push_back({command, rule, std::move(text)});
}

void CommandChecker::check_distances(const Channel& channel, const DramCommand& command) {
  for (const DramCommand& before : channel.recent) {
    if (before.clock >= command.clock) {
      report(command, "command bus",
             "another command was issued at clock " + std::to_string(before.clock));
      continue;
    }
    for (const Distance& rule : distances_[number(before.kind) * kKinds + number(command.kind)]) {
      if (rule.scope == Scope::same_bank && before.bank != command.bank) continue;
      if (rule.scope == Scope::other_bank && before.bank == command.bank) continue;
      const std::uint64_t clocks = command.clock - before.clock;
      if (clocks >= rule.clocks) continue;
      report(command, rule.name,
             std::to_string(clocks) + " clocks after " + to_string(before.kind) + " of bank " +
                 std::to_string(before.bank) + ", at least " + std::to_string(rule.clocks));
    }
  }
}

/// At most four activates in any tFAW clocks.
void CommandChecker::check_window(const Channel& channel, const DramCommand& command) {
  if (command.kind != DramCommandKind::activate) return;
  const auto activates =
      std::count_if(channel.recent.begin(), channel.recent.end(), [&](const DramCommand& before) {
        return before.kind == DramCommandKind::activate &&
               before.clock + spec_.tfaw > command.clock;
      });
  if (activates >= 4) {
    report(command, "tFAW", "the fifth activate in " + std::to_string(spec_.tfaw) + " clocks");
  }
}

/// Bursts do not overlap, and the bus turns round in time.
void CommandChecker::check_data_bus(Channel& channel, const DramCommand& command) {
  const bool reads = command.kind == DramCommandKind::read;
  if (!reads && command.kind != DramCommandKind::write) return;
  const std::uint64_t begin = command.clock + (reads ? spec_.cl : spec_.cwl);
  if (begin < channel.data_end) {
    report(command, "data bus",
           "its data starts at clock " + std::to_string(begin) + ", the burst before ends at " +
               std::to_string(channel.data_end));
  } else if (!reads) {
    for (const DramCommand& before : channel.recent) {
      const std::uint64_t free = before.clock + spec_.cl + spec_.burst_length / 2 + spec_.trtw_gap;
      if (before.kind == DramCommandKind::read && begin < free) {
        report(command, "read to write",
               "its data starts at clock " + std::to_string(begin) +
                   ", the bus has turned round at " + std::to_string(free));
      }
    }
  }
  channel.data_end = std::max(channel.data_end, begin + spec_.burst_length / 2);
}

/// The bank is open, or closed, as the command needs it; then as it leaves it.
void CommandChecker::check_state(Channel& channel, const DramCommand& command) {
  Bank& bank = channel.banks[command.bank];
  switch (command.kind) {
    case DramCommandKind::activate:
      if (bank.open) report(command, "state", "the bank is open");
      bank = {true, command.row};
      break;
    case DramCommandKind::precharge:
      bank.open = false;
      break;
    case DramCommandKind::read:
    case DramCommandKind::write:
      if (!bank.open) {
        report(command, "state", "the bank is closed");
      } else if (bank.row != command.row) {
        report(command, "row",
               "row " + std::to_string(bank.row) + " is open, not " + std::to_string(command.row));
      }
      break;
    case DramCommandKind::refresh_bank:
      if (bank.open) report(command, "state", "the bank is open");
      if (command.bank != channel.refreshes % spec_.banks) {
        report(command, "refresh order", "the turn is of another bank");
      }
      ++channel.refreshes;
      break;
    case DramCommandKind::refresh_all:
      for (const Bank& each : channel.banks) {
        if (each.open) {
          report(command, "state", "a bank is open");
          break;
        }
      }
      ++channel.refreshes;
      break;
  }
}

/// As many refreshes as time has passed, but for those that may be owed, and one whose banks are
/// being closed.
void CommandChecker::check_refresh(const Channel& channel, const DramCommand& command) {
  if (refresh_ == RefreshPolicy::none) return;
  const std::uint64_t share = refresh_ == RefreshPolicy::per_bank ? spec_.banks : 1;
  const std::uint64_t due = command.clock / (spec_.trefi / share);
  if (channel.refreshes + postpone_ + 1 < due) {
    report(command, "tREFI",
           std::to_string(due) + " refreshes were due, " + std::to_string(channel.refreshes) +
               " were issued");
  }
}

void CommandChecker::on_command(const DramCommand& command) {
  ++commands_;
  if (command.channel >= channels_.size() || command.bank >= spec_.banks ||
      command.row >= spec_.rows || command.column >= spec_.columns) {
    report(command, "address", "the device has no such place");
    return;
  }
  Channel& channel = channels_[command.channel];
  check_distances(channel, command);
  check_window(channel, command);
  check_data_bus(channel, command);
  check_refresh(channel, command);
  check_state(channel, command);
  channel.recent.push_back(command);
  // The turnaround rule looks back by cl, a burst and the gap.
  const std::uint64_t look_back =
      std::max<std::uint64_t>(longest_, spec_.cl + spec_.burst_length / 2 + spec_.trtw_gap);
  while (channel.recent.front().clock + look_back < command.clock) channel.recent.pop_front();
}

void CommandChecker::finish(std::uint64_t clock) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    check_refresh(channels_[i],
                  {clock, DramCommandKind::refresh_bank, static_cast<std::uint8_t>(i), 0, 0, 0});
  }
}

}  // namespace fasttree::model
