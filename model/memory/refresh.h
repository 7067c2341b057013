// SPDX-License-Identifier: Apache-2.0
// When a channel owes its device a refresh, and of which bank. Banks take turns, in order.
#pragma once

#include <cstdint>
#include <limits>

#include "model/memory/memory_config.h"

namespace fasttree::model {

class RefreshSchedule {
 public:
  RefreshSchedule(const DramSpec& spec, const ControllerConfig& controller)
      : policy_(controller.refresh),
        banks_(spec.banks),
        postpone_(controller.refresh_postpone),
        interval_(policy_ == RefreshPolicy::per_bank ? spec.trefi / spec.banks : spec.trefi) {}

  /// Commands due by this clock and not issued.
  std::uint64_t owed(std::uint64_t clock) const {
    return policy_ == RefreshPolicy::none ? 0 : clock / interval_ - issued_;
  }
  /// Requests have to wait for it now.
  bool urgent(std::uint64_t clock) const { return owed(clock) > postpone_; }
  /// The next clock at which one more is owed.
  std::uint64_t next_due(std::uint64_t clock) const {
    if (policy_ == RefreshPolicy::none) return std::numeric_limits<std::uint64_t>::max();
    return (clock / interval_ + 1) * interval_;
  }
  bool all_banks() const { return policy_ == RefreshPolicy::all_bank; }
  /// Whose turn it is, one bank at a time.
  std::uint32_t bank() const { return bank_; }

  void issued() {
    ++issued_;
    bank_ = (bank_ + 1) % banks_;
  }

 private:
  RefreshPolicy policy_;
  std::uint32_t banks_;
  std::uint64_t postpone_;
  std::uint64_t interval_;
  std::uint64_t issued_ = 0;
  std::uint32_t bank_ = 0;
};

}  // namespace fasttree::model
