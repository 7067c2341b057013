// SPDX-License-Identifier: Apache-2.0
#include "model/memory/channel.h"

#include <algorithm>
#include <bit>

#include "model/memory/statistics.h"

namespace fasttree::model {

namespace {

/// What comes first among commands that can go out at the same clock.
enum Rank : int { kRow, kColumn, kStarving, kRefresh, kNothing = -1 };

}  // namespace

/// The best command for a clock, and the clock of the soonest of those that come too early.
struct DramChannel::Choice {
  int rank = kNothing;
  std::uint64_t order = 0;
  DramCommandKind kind = DramCommandKind::activate;
  std::uint32_t bank = 0;
  Slot slot = kNoSlot;  ///< the request it serves; none for refresh
  std::uint64_t soonest = kNever;
  std::uint32_t blocked = 0;  ///< banks that are kept for a refresh

  void offer(int its_rank, std::uint64_t its_order, DramCommandKind its_kind,
             std::uint32_t its_bank, Slot its_slot, std::uint64_t earliest, std::uint64_t clock) {
    if (earliest > clock) {
      soonest = std::min(soonest, earliest);
    } else if (its_rank > rank || (its_rank == rank && its_order < order)) {
      rank = its_rank;
      order = its_order;
      kind = its_kind;
      bank = its_bank;
      slot = its_slot;
    }
  }
};

DramChannel::DramChannel(const DramSpec& spec, const ControllerConfig& controller,
                         std::uint8_t index, MemoryStatistics& statistics)
    : spec_(spec),
      config_(controller),
      index_(index),
      statistics_(statistics),
      timing_(spec),
      refresh_(spec, controller),
      reads_(controller.read_queue),
      writes_(controller.write_queue) {}

void DramChannel::accept(const MemoryRequest& request, const DramLocation& at, Picoseconds now) {
  QueuedRequest queued;
  queued.order = order_++;
  queued.arrival = processed_ + 1;
  queued.granule = request.address.value / spec_.access_bytes();
  queued.accepted = now;
  queued.at = at;
  queued.tag = request.tag;
  // Inside a queue the same bytes are in the same row, where older goes before younger. Only the
  // other queue has to be looked at.
  RequestQueue& other = request.write ? reads_ : writes_;
  queued.waits_for = other.youngest_of(queued.granule, at.bank);
  if (queued.waits_for != kNoSlot) other[queued.waits_for].is_waited_for = true;
  (request.write ? writes_ : reads_).add(queued);
  forget(at.bank, request.write);
  if (!request.write) last_read_ = queued.arrival;
  next_ = std::min(next_, queued.arrival);
}

/// From which clock on the oldest request of a queue is no more overtaken.
std::uint64_t DramChannel::starves_at(const RequestQueue& queue) const {
  const Slot oldest = queue.oldest();
  if (oldest == kNoSlot || queue[oldest].waits_for != kNoSlot) return kNever;
  return queue[oldest].arrival + config_.starvation_clocks;
}

/// Reading or writing. Gives the clock at which that may change by time alone.
std::uint64_t DramChannel::choose_direction(std::uint64_t clock) {
  const bool reads = reads_.eligible() > 0;
  const bool writes = writes_.eligible() > 0;
  if (!writes) writing_ = false;
  if (!reads && writing_) return kNever;
  if (!writes) return kNever;

  const bool read_needs_write = reads_.eligible() < reads_.count();
  const bool many = writes_.count() >= config_.write_drain_high;
  const std::uint64_t reads_starve = starves_at(reads_);
  const std::uint64_t writes_starve = starves_at(writes_);
  // Where both sides have waited too long, the older goes first.
  const bool reads_first = reads_starve <= clock && reads_starve <= writes_starve;
  if (writing_) {
    const bool few = writes_.count() <= config_.write_drain_low || (in_no_hurry_ && !many);
    const bool may_stop = few && !read_needs_write && writes_starve > clock;
    if (reads_first || may_stop) writing_ = false;
    return writing_ && reads_starve > clock ? reads_starve : kNever;
  }
  if (reads) {
    const bool must_write = many || read_needs_write || writes_starve <= clock;
    writing_ = must_write && !reads_first;
    in_no_hurry_ = false;
    return !must_write && writes_starve > clock ? writes_starve : kNever;
  }
  const std::uint64_t idle_over = last_read_ + config_.write_idle_clocks;
  const bool must_write = many || read_needs_write;
  writing_ = must_write || idle_over <= clock;
  in_no_hurry_ = !must_write;
  return writing_ ? kNever : idle_over;
}

void DramChannel::consider_refresh(Choice& choice, std::uint64_t clock) const {
  choice.soonest = refresh_.next_due(clock);
  if (refresh_.owed(clock) == 0) return;
  const std::uint32_t waiting = reads_.banks() | writes_.banks();
  const std::uint32_t all = (1u << spec_.banks) - 1;
  const std::uint32_t wanted = refresh_.all_banks() ? all : 1u << refresh_.bank();
  // In good time it goes before nothing that waits; later, all that is for these banks waits.
  if (!refresh_.urgent(clock) && (waiting & wanted) != 0) return;
  choice.blocked = wanted;
  bool closed = true;
  for (std::uint32_t rest = wanted; rest != 0; rest &= rest - 1) {
    const std::uint32_t bank = static_cast<std::uint32_t>(std::countr_zero(rest));
    if (!timing_.is_open(bank)) continue;
    closed = false;
    choice.offer(kRefresh, 0, DramCommandKind::precharge, bank, kNoSlot,
                 timing_.earliest(DramCommandKind::precharge, bank), clock);
  }
  if (!closed) return;
  const DramCommandKind kind =
      refresh_.all_banks() ? DramCommandKind::refresh_all : DramCommandKind::refresh_bank;
  choice.offer(kRefresh, 0, kind, refresh_.bank(), kNoSlot, timing_.earliest(kind, refresh_.bank()),
               clock);
}

DramChannel::Candidates& DramChannel::candidates(std::uint32_t bank) {
  Candidates& found = candidates_[bank + (writing_ ? BankTiming::kMaxBanks : 0)];
  if (found.known) return found;
  const RequestQueue& queue = writing_ ? writes_ : reads_;
  const bool open = timing_.is_open(bank);
  found = {true, kNoSlot, kNoSlot, 0, 0};
  for (Slot slot = queue.first(bank); slot != kNoSlot; slot = queue[slot].next) {
    if (queue[slot].waits_for != kNoSlot) continue;
    if (found.oldest == kNoSlot) {
      found.oldest = slot;
      found.starves_at = queue[slot].arrival + config_.starvation_clocks;
    }
    if (!open) break;
    if (queue[slot].at.row == timing_.open_row(bank)) {
      found.hit = slot;
      break;
    }
  }
  return found;
}

/// Offers the command that the requests of this bank want most.
void DramChannel::consider_bank(Choice& choice, std::uint32_t bank, std::uint64_t clock) {
  const RequestQueue& queue = writing_ ? writes_ : reads_;
  Candidates& found = candidates(bank);
  if (found.oldest == kNoSlot) return;
  const bool starving = found.starves_at <= clock;
  if (!starving) {
    choice.soonest = std::min(choice.soonest, found.starves_at);
    if (found.not_before > clock) {
      choice.soonest = std::min(choice.soonest, found.not_before);
      return;
    }
  }
  if (found.hit != kNoSlot && (found.hit == found.oldest || !starving)) {
    const DramCommandKind kind = writing_ ? DramCommandKind::write : DramCommandKind::read;
    found.not_before = timing_.earliest(kind, bank);
    choice.offer(starving ? kStarving : kColumn, queue[found.hit].order, kind, bank, found.hit,
                 found.not_before, clock);
    return;
  }
  const DramCommandKind kind =
      timing_.is_open(bank) ? DramCommandKind::precharge : DramCommandKind::activate;
  found.not_before = timing_.earliest(kind, bank);
  choice.offer(starving ? kStarving : kRow, queue[found.oldest].order, kind, bank, found.oldest,
               found.not_before, clock);
}

std::uint64_t DramChannel::step(std::uint64_t clock) {
  Choice choice;
  consider_refresh(choice, clock);
  choice.soonest = std::min(choice.soonest, choose_direction(clock));
  const std::uint32_t banks = (writing_ ? writes_ : reads_).banks() & ~choice.blocked;
  for (std::uint32_t rest = banks; rest != 0; rest &= rest - 1) {
    consider_bank(choice, static_cast<std::uint32_t>(std::countr_zero(rest)), clock);
  }
  if (choice.rank == kNothing) return choice.soonest;
  carry_out(choice, clock);
  return clock + 1;
}

void DramChannel::carry_out(const Choice& choice, std::uint64_t clock) {
  RequestQueue& queue = writing_ ? writes_ : reads_;
  DramCommand command{clock, choice.kind, index_, static_cast<std::uint8_t>(choice.bank), 0, 0};
  if (choice.slot != kNoSlot) {
    QueuedRequest& request = queue[choice.slot];
    if (choice.kind == DramCommandKind::activate) request.activated = true;
    if (choice.kind == DramCommandKind::precharge) request.precharged = true;
    if (choice.kind != DramCommandKind::precharge) command.row = request.at.row;
    command.column = request.at.column;
  }
  timing_.issue(choice.kind, choice.bank, command.row, clock);
  if (choice.kind == DramCommandKind::activate || choice.kind == DramCommandKind::precharge) {
    forget(choice.bank, false);
    forget(choice.bank, true);
  }
  if (observer_ != nullptr) observer_->on_command(command);
  switch (choice.kind) {
    case DramCommandKind::read:
    case DramCommandKind::write:
      finish(choice.slot, clock);
      break;
    case DramCommandKind::refresh_bank:
    case DramCommandKind::refresh_all:
      refresh_.issued();
      ++statistics_.refreshes;
      break;
    case DramCommandKind::activate:
    case DramCommandKind::precharge:
      break;
  }
}

/// The request's read or write command has gone out.
void DramChannel::finish(Slot slot, std::uint64_t clock) {
  RequestQueue& queue = writing_ ? writes_ : reads_;
  const QueuedRequest& request = queue[slot];
  ++(request.precharged  ? statistics_.row_conflicts
     : request.activated ? statistics_.row_misses
                         : statistics_.row_hits);
  if (writing_ != last_was_write_) ++statistics_.turnarounds;
  last_was_write_ = writing_;
  if (!writing_) {
    last_read_ = clock;
    const Picoseconds at((clock + spec_.cl + spec_.burst_clocks()) * spec_.tck_ps);
    completions_.push({request.tag, false, at});
    record_read_latency(statistics_, at - request.accepted);
  }
  if (request.is_waited_for) {
    // Same bytes, same bank.
    (writing_ ? reads_ : writes_).release_waiting_for(slot, request.at.bank);
    forget(request.at.bank, !writing_);
  }
  forget(request.at.bank, writing_);
  queue.remove(slot);
}

std::string DramChannel::waits_for() const {
  const Slot read = reads_.oldest();
  const Slot write = writes_.oldest();
  if (read == kNoSlot && write == kNoSlot) return "";
  const bool is_write =
      read == kNoSlot || (write != kNoSlot && writes_[write].order < reads_[read].order);
  const QueuedRequest& oldest = is_write ? writes_[write] : reads_[read];
  const std::uint32_t bank = oldest.at.bank;
  std::string text = std::string(is_write ? "write" : "read") + " of channel " +
                     std::to_string(index_) + ", bank " + std::to_string(bank) + ", row " +
                     std::to_string(oldest.at.row) + ", waiting since clock " +
                     std::to_string(oldest.arrival) + ": ";
  if (is_write != writing_) return text + (writing_ ? "writes go first" : "reads go first");
  if (!timing_.is_open(bank)) return text + "for its row to be opened";
  if (timing_.open_row(bank) != oldest.at.row) return text + "for another row to be closed";
  return text + "for the data bus";
}

}  // namespace fasttree::model
