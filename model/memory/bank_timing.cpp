// SPDX-License-Identifier: Apache-2.0
#include "model/memory/bank_timing.h"

#include <algorithm>
#include <cassert>

namespace fasttree::model {

BankTiming::BankTiming(const DramSpec& spec)
    : spec_(spec),
      // The data written may start trtw_gap after the last data read.
      read_to_write_(spec.cl + spec.burst_clocks() + spec.trtw_gap - spec.cwl),
      write_to_read_(spec.cwl + spec.burst_clocks() + spec.twtr) {
  assert(spec.banks <= kMaxBanks);
}

bool BankTiming::any_open() const {
  return std::any_of(banks_.begin(), banks_.begin() + spec_.banks,
                     [](const Bank& bank) { return bank.open; });
}

void BankTiming::issue(DramCommandKind kind, std::uint32_t b, std::uint32_t row,
                       std::uint64_t clock) {
  Bank& bank = banks_[b];
  const auto not_before = [](std::uint64_t& at, std::uint64_t then) { at = std::max(at, then); };
  command_ = clock + 1;
  switch (kind) {
    case DramCommandKind::activate:
      bank.open = true;
      bank.row = row;
      not_before(bank.column, clock + spec_.trcd);
      not_before(bank.precharge, clock + spec_.tras);
      not_before(bank.activate, clock + spec_.trc);
      not_before(activate_, clock + spec_.trrd);
      window_[window_next_] = clock + spec_.tfaw;
      window_next_ = (window_next_ + 1) % window_.size();
      break;
    case DramCommandKind::precharge:
      bank.open = false;
      not_before(bank.activate, clock + spec_.trp);
      break;
    case DramCommandKind::read:
      not_before(read_, clock + spec_.tccd);
      not_before(write_, clock + read_to_write_);
      not_before(bank.precharge, clock + spec_.trtp);
      break;
    case DramCommandKind::write:
      not_before(write_, clock + spec_.tccd);
      not_before(read_, clock + write_to_read_);
      not_before(bank.precharge, clock + spec_.cwl + spec_.burst_clocks() + spec_.twr);
      break;
    case DramCommandKind::refresh_bank:
      not_before(bank.activate, clock + spec_.trfc_pb);
      not_before(activate_, clock + spec_.trrd);
      not_before(refresh_, clock + spec_.trfc_pb);
      break;
    case DramCommandKind::refresh_all:
      for (std::uint32_t i = 0; i < spec_.banks; ++i) {
        not_before(banks_[i].activate, clock + spec_.trfc_ab);
      }
      not_before(refresh_, clock + spec_.trfc_ab);
      break;
  }
}

}  // namespace fasttree::model
