// SPDX-License-Identifier: Apache-2.0
// How often to do something that a few times show and many times prove, and whether memory grew.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>

namespace fasttree::device::test {

/// What the environment's variable says.
inline std::uint64_t asked(const char* variable, std::uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

inline std::uint64_t resident_kib() {
  std::uint64_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) / 1024;
}

/// Sanitizers keep what was freed.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kMemoryIsFlat = false;
#else
inline constexpr bool kMemoryIsFlat = true;
#endif

}  // namespace fasttree::device::test
