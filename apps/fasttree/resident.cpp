// SPDX-License-Identifier: Apache-2.0
#include "resident.h"

#include <fstream>
#include <string>

namespace fasttree::app {
namespace {

std::optional<std::uint64_t> status_kilobytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kilobytes = 0;
    if (word == key && status >> kilobytes) return kilobytes * 1024;
  }
  return std::nullopt;
}

}  // namespace

ResidentPeak::ResidentPeak() {
  // Lets the highest mark begin anew from what is resident now.
  std::ofstream reset("/proc/self/clear_refs");
  if (reset << "5" && reset.flush()) before_ = status_kilobytes("VmRSS:");
}

std::optional<std::uint64_t> ResidentPeak::grown() const {
  const auto peak = status_kilobytes("VmHWM:");
  if (!before_ || !peak) return std::nullopt;
  return *peak > *before_ ? *peak - *before_ : 0;
}

}  // namespace fasttree::app
