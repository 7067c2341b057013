// SPDX-License-Identifier: Apache-2.0
// Requests that wait in a channel, in one direction: slots of a fixed array, linked by bank in the
// order of arrival.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cstdint>

#include "model/kernel/quantities.h"
#include "model/memory/address_map.h"
#include "model/memory/bank_timing.h"
#include "model/memory/memory.h"

namespace fasttree::model {

/// Index of a slot; kNoSlot: none.
using Slot = std::int8_t;
inline constexpr Slot kNoSlot = -1;

struct QueuedRequest {
  std::uint64_t order = 0;    ///< of acceptance, over both queues
  std::uint64_t arrival = 0;  ///< first clock at which it may be served
  std::uint64_t granule = 0;  ///< which burst of memory it is
  Picoseconds accepted;
  DramLocation at;
  std::uint32_t tag = 0;
  bool activated = false;      ///< its row was opened for it
  bool precharged = false;     ///< another row was closed for it
  bool is_waited_for = false;  ///< by a request of the other queue
  Slot waits_for = kNoSlot;    ///< of the other queue: touches the same bytes, and is older
  Slot next = kNoSlot;         ///< of the same bank
  Slot previous = kNoSlot;
};

class RequestQueue {
 public:
  static constexpr std::uint32_t kMaxDepth = 64;

  explicit RequestQueue(std::uint32_t depth)
      : depth_(depth), free_(depth >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << depth) - 1) {
    first_.fill(kNoSlot);
    last_.fill(kNoSlot);
  }

  bool full() const { return count_ == depth_; }
  std::uint32_t count() const { return count_; }
  /// Those that wait for no request of the other queue.
  std::uint32_t eligible() const { return count_ - waiting_; }
  /// One bit a bank that has requests.
  std::uint32_t banks() const { return banks_; }
  Slot first(std::uint32_t bank) const { return first_[bank]; }
  QueuedRequest& operator[](Slot slot) { return slots_[static_cast<std::size_t>(slot)]; }
  const QueuedRequest& operator[](Slot slot) const {
    return slots_[static_cast<std::size_t>(slot)];
  }

  Slot add(const QueuedRequest& request) {
    assert(!full());
    const Slot slot = static_cast<Slot>(std::countr_zero(free_));
    free_ &= free_ - 1;
    QueuedRequest& q = (*this)[slot] = request;
    const std::uint32_t bank = q.at.bank;
    q.next = kNoSlot;
    q.previous = last_[bank];
    (q.previous == kNoSlot ? first_[bank] : (*this)[q.previous].next) = slot;
    last_[bank] = slot;
    banks_ |= 1u << bank;
    if (q.waits_for != kNoSlot) ++waiting_;
    ++at_granule_[q.granule % at_granule_.size()];
    ++count_;
    return slot;
  }

  void remove(Slot slot) {
    const QueuedRequest& q = (*this)[slot];
    assert(q.waits_for == kNoSlot);
    const std::uint32_t bank = q.at.bank;
    (q.previous == kNoSlot ? first_[bank] : (*this)[q.previous].next) = q.next;
    (q.next == kNoSlot ? last_[bank] : (*this)[q.next].previous) = q.previous;
    if (first_[bank] == kNoSlot) banks_ &= ~(1u << bank);
    free_ |= std::uint64_t{1} << slot;
    --at_granule_[q.granule % at_granule_.size()];
    --count_;
  }

  /// The youngest request to this burst of memory, or kNoSlot.
  Slot youngest_of(std::uint64_t granule, std::uint32_t bank) const {
    if (at_granule_[granule % at_granule_.size()] == 0) return kNoSlot;  // nearly always
    for (Slot slot = last_[bank]; slot != kNoSlot; slot = (*this)[slot].previous) {
      if ((*this)[slot].granule == granule) return slot;
    }
    return kNoSlot;
  }

  /// Nobody waits for this slot of the other queue, a request to this bank, any more.
  void release_waiting_for(Slot of_other, std::uint32_t bank) {
    for (Slot slot = first_[bank]; slot != kNoSlot; slot = (*this)[slot].next) {
      if ((*this)[slot].waits_for != of_other) continue;
      (*this)[slot].waits_for = kNoSlot;
      --waiting_;
    }
  }

  /// The oldest of all, or kNoSlot.
  Slot oldest() const {
    Slot best = kNoSlot;
    for (std::uint32_t rest = banks_; rest != 0; rest &= rest - 1) {
      const Slot slot = first_[static_cast<std::size_t>(std::countr_zero(rest))];
      if (best == kNoSlot || (*this)[slot].order < (*this)[best].order) best = slot;
    }
    return best;
  }

 private:
  std::uint32_t depth_;
  std::uint32_t count_ = 0;
  std::uint32_t waiting_ = 0;
  std::uint32_t banks_ = 0;
  std::uint64_t free_;
  std::array<QueuedRequest, kMaxDepth> slots_;
  std::array<Slot, BankTiming::kMaxBanks> first_, last_;
  /// How many requests share a hash: answers "none of these bytes" without a search.
  std::array<std::uint8_t, 256> at_granule_{};
};

}  // namespace fasttree::model
