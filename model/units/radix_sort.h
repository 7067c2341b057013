// SPDX-License-Identifier: Apache-2.0
// Radix sort unit (RSU): control of the rounds of counting sort over the prefix sum units. A
// section is fetched, its flags are scanned digit by digit, then its pairs move to their places.
// Docs: docs/accelerator/radix_sort.md.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/system/stream.h"
#include "model/units/prefix_sum.h"

namespace fasttree::model {

inline constexpr std::uint32_t kMaxPairsPerCycle = 4;

/// Where a round reads and writes.
struct SortRound {
  std::uint32_t number = 0;
  bool last = false;  ///< codes and ids go to arrays of their own
  std::uint64_t pairs = 0;
  Address from;
  Address to;      ///< pairs, or the codes in the last round
  Address to_ids;  ///< in the last round
};

class RadixSortUnit : public Unit {
 public:
  /// Reads do not wait behind the writes: each have a port.
  RadixSortUnit(const PaperConfig& config, BusPort& reads, BusPort& port,
                std::vector<PrefixSumUnit*> psus);

  /// `counts`: how often each digit of this round occurs; made here where the configuration has a
  /// pass for it.
  void start(const SortRound& round, const std::vector<std::uint32_t>& counts);

  void tick() override;
  bool done() const override { return state_ == State::done; }
  std::string waits_for() const override;

  /// Of the next round's digit, after a round.
  const std::vector<std::uint32_t>& next_counts() const { return next_counts_; }

 private:
  enum class State { count, offsets, move, drain, flush, finish, done };
  enum class Work { none, scan, scatter };
  struct Buffer {
    std::vector<std::uint8_t> raw;
    std::vector<std::uint32_t> code, id, place;
    std::vector<std::uint16_t> digit;  ///< of this round; no digit behind the last pair
    std::uint32_t bytes = 0;           ///< fetched
    std::uint32_t want = 0;            ///< bytes of the section; 0: none being fetched
    std::uint32_t count = 0;
  };
  struct Item {
    std::uint32_t code = 0, id = 0, place = 0, digit = 0;
  };
  /// Pairs that are scattered in one cycle, on their way.
  struct Group {
    std::uint32_t count = 0;
    std::array<Item, kMaxPairsPerCycle> items;
  };

  bool step();
  bool count_pass();
  bool offsets();
  void start_writers();
  bool fetch();
  void begin_fetch(Buffer& buffer);
  void unpack(Buffer& buffer);
  bool scan();
  void send_flags();
  void collect_sums();
  bool scatter();
  void choose_work();
  bool blocks_take(const Group& group) const;
  bool room_for_blocks() const;
  void place(const Item& item);
  void advance();
  void put(std::uint32_t digit, BlockWriter& writer, const void* bytes, std::uint32_t size);
  void hand_on();
  void flush(std::uint32_t digit);
  std::uint32_t digit(std::uint32_t code, std::uint32_t round) const {
    return static_cast<std::uint32_t>(
        std::uint64_t{code} >> (round * config_.radix_sort.radix_bits) & (radix_ - 1));
  }

  PaperConfig config_;
  std::uint32_t radix_;
  std::uint32_t pair_size_;
  std::uint32_t capacity_;  ///< pairs of a section over all units
  BusPort& port_;
  StreamReader reader_;
  std::vector<PrefixSumUnit*> psus_;
  State state_ = State::done;
  SortRound round_;
  std::vector<std::uint32_t> counts_, next_counts_;
  std::vector<std::uint32_t> begin_;  ///< a digit: where its next pair goes
  std::uint32_t offset_digits_ = 0;   ///< whose begins are known
  std::uint32_t offset_ = 0;          ///< of the section of counts
  bool offset_asked_ = false;
  std::array<std::uint8_t, 2 * kMaxRequestBytes> partial_{};  ///< count pass: bytes of pairs
  std::uint32_t partial_bytes_ = 0;
  std::array<Buffer, 2> buffers_;
  std::uint32_t loading_ = 0, working_ = 0;
  Work work_ = Work::none;
  std::uint32_t asked_digits_ = 0, summed_digits_ = 0;
  bool flags_made_ = false;  ///< of digit `asked_digits_`, not sent yet
  std::uint32_t next_pair_ = 0;
  std::uint64_t fetched_pairs_ = 0;
  Group ranked_, placed_;             ///< registers between the section and the blocks
  bool reading_ = false;              ///< something was in `ranked_` as the cycle began
  bool advanced_ = false;             ///< in this cycle
  bool empty_ = true;                 ///< as the cycle began: no pair, block or request on its way
  std::vector<BlockWriter> writers_;  ///< a digit
  std::vector<BlockWriter> id_writers_;     ///< a digit, last round
  Queue<BusRequest> blocks_;                ///< full ones
  std::deque<std::uint32_t> block_digits_;  ///< of `blocks_`
  std::vector<std::uint32_t> waiting_;      ///< a digit: full blocks
  BusRequest out_;                          ///< a register before the port
  bool out_full_ = false;
  std::uint32_t next_flush_ = 0;
  std::size_t waits_ = 0;
};

}  // namespace fasttree::model
