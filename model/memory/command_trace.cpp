// SPDX-License-Identifier: Apache-2.0
#include "model/memory/command_trace.h"

namespace fasttree::model {

std::string to_line(const DramCommand& command) {
  return std::to_string(command.clock) + ' ' + std::to_string(command.channel) + ' ' +
         to_string(command.kind) + ' ' + std::to_string(command.bank) + ' ' +
         std::to_string(command.row) + ' ' + std::to_string(command.column) + '\n';
}

void CommandTrace::on_command(const DramCommand& command) {
  buffer_ += to_line(command);
  if (buffer_.size() >= std::size_t{64} << 10) finish();
}

void CommandTrace::finish() {
  sink_(buffer_);
  buffer_.clear();
}

}  // namespace fasttree::model
