// SPDX-License-Identifier: Apache-2.0
// Off-chip memory as an AXI4 slave: the time of a model::Memory, the bytes of a model::ByteStore.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "model/memory/byte_store.h"
#include "model/memory/memory.h"
#include "rtl/bench/axi_signals.h"

namespace fasttree::rtl {

/// Is told of every burst: once it was carried out in the store.
class AxiObserver {
 public:
  virtual ~AxiObserver() = default;
  /// `bytes`: of a read those of its beats from the address on, of a write those with strobes.
  virtual void burst(std::uint32_t address, std::uint32_t bytes, bool write, std::uint32_t id) = 0;
};

struct AxiMemoryOptions {
  double clock_mhz = 1000;
  std::uint32_t bus_bytes = 16;
  std::uint32_t commands_per_cycle = 2;  ///< for reads, as bus_commands_per_cycle of the model
  /// Everything that AXI leaves to a slave is thrown for: readiness, delays, order between IDs,
  /// beats of several IDs mixed, gaps, and writes that take effect only when they are answered.
  bool wild = false;
  std::uint32_t seed = 1;
};

/// A cycle: drive(), evaluate the master, clock(), the rising edge of the master. What is driven
/// depends on earlier cycles only. Bursts of up to 64 bytes within 64 aligned ones. With a tame
/// memory a burst's beats come when all of it has arrived, without gaps, the oldest burst first.
class AxiMemory {
 public:
  AxiMemory(model::Memory& memory, model::ByteStore& store, const AxiMemoryOptions& options);

  void drive(AxiSignals& axi);
  void clock(const AxiSignals& axi);

  /// Nothing taken that was not answered.
  bool idle() const;
  std::uint64_t cycles() const { return cycle_; }
  /// Grows with everything that passes.
  std::uint64_t progress() const { return progress_; }

  void observe(AxiObserver* observer) { observer_ = observer; }

  /// The n-th burst from now (1 is the next) of its kind is answered with SLVERR.
  void fail_read(std::uint64_t n) { fail_read_ = n; }
  void fail_write(std::uint64_t n) { fail_write_ = n; }
  /// Bursts there are answered with DECERR, as are those outside the store.
  void refuse(std::uint32_t from, std::uint32_t to) { refuse_from_ = from, refuse_to_ = to; }
  /// The n-th beat from now is lost: a write's bytes do not arrive, a read's never come.
  void lose_beat(std::uint64_t n) { lose_beat_ = n; }

  /// What the master did against the rules, the first of it; empty: nothing.
  const std::string& violation() const { return violation_; }

 private:
  static constexpr std::size_t kIds = 16;
  static constexpr std::size_t kBursts = 128;
  static constexpr std::size_t kMaxBeats = 16;
  static constexpr std::uint32_t kBlock = 64;
  enum Response : std::uint32_t { kOkay = 0, kSlaveError = 2, kDecodeError = 3 };

  struct Burst {
    bool write = false;
    std::uint32_t id = 0;
    std::uint32_t address = 0;
    std::uint32_t length = 0;  ///< beats less one
    std::uint32_t bytes = 0;
    std::uint32_t issued = 0;   ///< bytes handed to memory
    std::uint32_t waiting = 0;  ///< accesses to come back
    std::uint32_t beat = 0;     ///< next to deliver
    std::uint32_t response = kOkay;
    std::uint64_t not_before = 0;  ///< cycle
    std::uint64_t strobes = 0;     ///< of a write, by byte of the aligned 64
    std::array<std::uint8_t, kBlock> data{};
  };
  /// Numbers of bursts, first in, first out.
  struct Ring {
    std::array<std::uint8_t, kBursts> slots{};
    std::uint32_t head = 0, count = 0;
    void push(std::uint8_t burst) { slots[(head + count++) % kBursts] = burst; }
    std::uint8_t front() const { return slots[head]; }
    std::uint8_t pop() {
      const std::uint8_t burst = slots[head];
      head = (head + 1) % kBursts;
      --count;
      return burst;
    }
  };

  void take_address(const AxiSignals& axi, bool write);
  void take_beat(const AxiSignals& axi);
  void assemble_write();
  void issue_write();
  void issue_reads();
  bool hand_on(std::uint8_t number);
  void carried_out(const Burst& burst);
  void put_into_store(const Burst& burst);
  void offer_read(AxiSignals& axi);
  void offer_response(AxiSignals& axi);
  bool choose(std::uint32_t ids, const std::array<Ring, kIds>& rings, std::uint32_t& id);
  std::uint32_t response(std::uint32_t address, std::uint32_t bytes, bool write);
  bool wild_chance(std::uint32_t percent) { return !options_.wild || random_() % 100 < percent; }
  bool lost() { return lose_beat_ != 0 && --lose_beat_ == 0; }
  void object(const char* what) {
    if (violation_.empty()) violation_ = what;
  }

  model::Memory& memory_;
  model::ByteStore& store_;
  AxiMemoryOptions options_;
  double period_ps_;
  std::uint32_t access_bytes_;
  std::mt19937 random_;
  std::uint64_t cycle_ = 0;
  model::Picoseconds now_;
  std::uint64_t progress_ = 0;

  std::array<Burst, kBursts> bursts_;
  Ring free_;
  Ring reads_to_issue_;
  Ring write_addresses_;
  std::array<Ring, kIds> reads_, writes_;       ///< in the order of their addresses, by ID
  std::uint32_t read_ids_ = 0, write_ids_ = 0;  ///< bits of those that have any

  // Beats of the write that comes in; they may come before their address.
  std::array<AxiSignals::Data, kMaxBeats> beats_;
  std::array<std::uint64_t, kMaxBeats> beat_strobes_{};
  std::uint32_t beat_count_ = 0;
  bool beats_complete_ = false;
  bool assembled_ = false;  ///< into the burst at the front of write_addresses_

  // What was driven in this cycle.
  bool ar_ready_ = false, aw_ready_ = false, w_ready_ = false;
  bool r_offered_ = false, b_offered_ = false;  ///< and stays until taken
  std::uint32_t r_id_ = 0, b_id_ = 0;
  bool in_burst_ = false;  ///< of r_id_

  AxiObserver* observer_ = nullptr;
  std::uint64_t fail_read_ = 0, fail_write_ = 0, lose_beat_ = 0;
  std::uint32_t refuse_from_ = 0, refuse_to_ = 0;
  std::string violation_;
};

}  // namespace fasttree::rtl
