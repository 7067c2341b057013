// SPDX-License-Identifier: Apache-2.0
// The controller of one channel: which command goes out at which clock. Row hits before others,
// older before younger, reads before writes until enough writes wait, a bound on being overtaken,
// refresh in time. Clocks at which nothing can go out are skipped.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "model/memory/bank_timing.h"
#include "model/memory/completion_queue.h"
#include "model/memory/dram_command.h"
#include "model/memory/refresh.h"
#include "model/memory/request_queue.h"

namespace fasttree::model {

class DramChannel {
 public:
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  DramChannel(const DramSpec& spec, const ControllerConfig& controller, std::uint8_t index,
              MemoryStatistics& statistics);

  bool ready(bool write) const { return !(write ? writes_ : reads_).full(); }
  /// Only where ready(). May be served from the clock after the last advance() on.
  void accept(const MemoryRequest& request, const DramLocation& at, Picoseconds now);

  /// Carries out every clock up to and including this one.
  void advance(std::uint64_t clock) {
    while (next_ <= clock) next_ = step(next_);
    processed_ = clock;
  }

  bool idle() const { return reads_.count() + writes_.count() == 0; }
  CompletionQueue& completions() { return completions_; }
  const CompletionQueue& completions() const { return completions_; }
  std::string waits_for() const;
  void observe(CommandObserver* observer) { observer_ = observer; }

 private:
  struct Choice;
  /// Of a bank's requests in one direction, that may be served: the oldest, and the oldest that
  /// finds its row open. Looked up anew only after a change.
  struct Candidates {
    bool known = false;
    Slot oldest = kNoSlot;
    Slot hit = kNoSlot;
    std::uint64_t starves_at = 0;  ///< clock from which the oldest is no more overtaken
    /// Nothing can go out before; deadlines only move away, so it stays true.
    std::uint64_t not_before = 0;
  };

  /// One clock: issues at most one command; gives the next clock at which there may be work.
  std::uint64_t step(std::uint64_t clock);
  std::uint64_t choose_direction(std::uint64_t clock);
  std::uint64_t starves_at(const RequestQueue& queue) const;
  void consider_refresh(Choice& choice, std::uint64_t clock) const;
  void consider_bank(Choice& choice, std::uint32_t bank, std::uint64_t clock);
  Candidates& candidates(std::uint32_t bank);
  void carry_out(const Choice& choice, std::uint64_t clock);
  void finish(Slot slot, std::uint64_t clock);
  void forget(std::uint32_t bank, bool write) {
    candidates_[bank + (write ? BankTiming::kMaxBanks : 0)].known = false;
  }

  DramSpec spec_;
  ControllerConfig config_;
  std::uint8_t index_;
  MemoryStatistics& statistics_;
  BankTiming timing_;
  RefreshSchedule refresh_;
  RequestQueue reads_;
  RequestQueue writes_;
  std::array<Candidates, 2 * BankTiming::kMaxBanks> candidates_;  ///< of reads, then of writes
  CompletionQueue completions_;
  CommandObserver* observer_ = nullptr;

  bool writing_ = false;         ///< the queue that is being served
  bool in_no_hurry_ = false;     ///< writing only because no read waits
  bool last_was_write_ = false;  ///< on the data bus
  std::uint64_t last_read_ = 0;  ///< clock at which a read last came or went
  std::uint64_t order_ = 0;
  std::uint64_t next_ = 0;       ///< nothing to do before this clock
  std::uint64_t processed_ = 0;  ///< clock of the last advance()
};

}  // namespace fasttree::model
