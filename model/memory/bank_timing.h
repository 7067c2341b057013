// SPDX-License-Identifier: Apache-2.0
// The controller's own account of a channel's banks: which row is open, and from which clock each
// command keeps all timing rules. A rule is applied when a command issues, by moving the earliest
// clocks of those it holds up; asking is then a maximum of few numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "model/memory/dram_command.h"
#include "model/memory/memory_config.h"

namespace fasttree::model {

class BankTiming {
 public:
  static constexpr std::uint32_t kMaxBanks = 16;

  explicit BankTiming(const DramSpec& spec);

  bool is_open(std::uint32_t bank) const { return banks_[bank].open; }
  std::uint32_t open_row(std::uint32_t bank) const { return banks_[bank].row; }
  bool any_open() const;

  /// The first clock at which the command keeps every rule, given that the bank is in the right
  /// state for it (open for read, write and precharge, closed for the others).
  std::uint64_t earliest(DramCommandKind kind, std::uint32_t bank) const;

  /// The command goes out at this clock.
  void issue(DramCommandKind kind, std::uint32_t bank, std::uint32_t row, std::uint64_t clock);

 private:
  struct Bank {
    bool open = false;
    std::uint32_t row = 0;
    std::uint64_t activate = 0;   ///< earliest activate or refresh: tRP, tRC, tRFC
    std::uint64_t precharge = 0;  ///< tRAS, tRTP, tWR
    std::uint64_t column = 0;     ///< tRCD
  };

  DramSpec spec_;
  std::uint32_t read_to_write_;
  std::uint32_t write_to_read_;
  std::array<Bank, kMaxBanks> banks_;
  std::uint64_t command_ = 0;   ///< one command a clock
  std::uint64_t activate_ = 0;  ///< tRRD
  std::uint64_t read_ = 0;      ///< tCCD, tWTR
  std::uint64_t write_ = 0;     ///< tCCD, read to write
  std::uint64_t refresh_ = 0;   ///< one refresh after the other
  /// For tFAW: when the last four activates leave the window, the oldest at window_next_.
  std::array<std::uint64_t, 4> window_{};
  std::uint32_t window_next_ = 0;
};

inline std::uint64_t BankTiming::earliest(DramCommandKind kind, std::uint32_t b) const {
  const Bank& bank = banks_[b];
  switch (kind) {
    case DramCommandKind::activate:
      return std::max({bank.activate, activate_, window_[window_next_], command_});
    case DramCommandKind::precharge:
      return std::max(bank.precharge, command_);
    case DramCommandKind::read:
      return std::max({bank.column, read_, command_});
    case DramCommandKind::write:
      return std::max({bank.column, write_, command_});
    case DramCommandKind::refresh_bank:
      return std::max({bank.activate, activate_, refresh_, command_});
    case DramCommandKind::refresh_all: {
      std::uint64_t clock = std::max(refresh_, command_);
      for (std::uint32_t i = 0; i < spec_.banks; ++i) clock = std::max(clock, banks_[i].activate);
      return clock;
    }
  }
  return 0;
}

}  // namespace fasttree::model
