// SPDX-License-Identifier: Apache-2.0
// A command on a channel's command bus, and who wants to see all of them.
#pragma once

#include <cstdint>

namespace fasttree::model {

enum class DramCommandKind : std::uint8_t {
  activate,
  precharge,
  read,
  write,
  refresh_bank,
  refresh_all,
};

inline const char* to_string(DramCommandKind kind) {
  switch (kind) {
    case DramCommandKind::activate:
      return "ACT";
    case DramCommandKind::precharge:
      return "PRE";
    case DramCommandKind::read:
      return "RD";
    case DramCommandKind::write:
      return "WR";
    case DramCommandKind::refresh_bank:
      return "REFpb";
    case DramCommandKind::refresh_all:
      return "REFab";
  }
  return "?";
}

struct DramCommand {
  std::uint64_t clock = 0;
  DramCommandKind kind = DramCommandKind::activate;
  std::uint8_t channel = 0;
  std::uint8_t bank = 0;     ///< not of refresh_all
  std::uint32_t row = 0;     ///< of activate, read and write
  std::uint32_t column = 0;  ///< of read and write: the burst's first
};

/// Sees each command of a memory, channel by channel in order of time.
class CommandObserver {
 public:
  virtual ~CommandObserver() = default;
  virtual void on_command(const DramCommand& command) = 0;
};

}  // namespace fasttree::model
