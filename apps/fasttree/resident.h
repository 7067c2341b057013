// SPDX-License-Identifier: Apache-2.0
// How much memory a piece of work really took: pages of this process, as the system counts them.
#pragma once

#include <cstdint>
#include <optional>

namespace fasttree::app {

class ResidentPeak {
 public:
  /// Begins to count. Where the system does not tell (no /proc), grown() has nothing to say.
  ResidentPeak();

  /// Bytes by which this process was larger at most than when the count began.
  std::optional<std::uint64_t> grown() const;

 private:
  std::optional<std::uint64_t> before_;
};

}  // namespace fasttree::app
