// SPDX-License-Identifier: Apache-2.0
#include "rtl/bench/axi_memory.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace fasttree::rtl {
namespace {

// More would not be seen by the master, and keeps no more work ready for the memory.
constexpr std::uint32_t kAddressQueue = 4;
constexpr std::uint32_t kWildDelay = 60;  // cycles

}  // namespace

AxiMemory::AxiMemory(model::Memory& memory, model::ByteStore& store,
                     const AxiMemoryOptions& options)
    : memory_(memory),
      store_(store),
      options_(options),
      period_ps_(1e6 / options.clock_mhz),
      access_bytes_(memory.traits().access_bytes),
      random_(options.seed) {
  for (std::size_t i = 0; i < kBursts; ++i) free_.push(static_cast<std::uint8_t>(i));
}

bool AxiMemory::idle() const {
  return free_.count == kBursts && beat_count_ == 0;
}

void AxiMemory::drive(AxiSignals& axi) {
  now_ = model::Picoseconds(static_cast<std::uint64_t>(static_cast<double>(++cycle_) * period_ps_));
  memory_.advance(now_);
  model::MemoryCompletion completion;
  while (memory_.take(completion)) {
    --bursts_[completion.tag].waiting;
    ++progress_;
  }
  axi.ar_ready = ar_ready_ =
      free_.count >= 2 && reads_to_issue_.count < kAddressQueue && wild_chance(70);
  axi.aw_ready = aw_ready_ =
      free_.count >= 2 && write_addresses_.count < kAddressQueue && wild_chance(70);
  axi.w_ready = w_ready_ = !beats_complete_ && wild_chance(80);
  if (!r_offered_) offer_read(axi);
  if (!b_offered_) offer_response(axi);
}

void AxiMemory::clock(const AxiSignals& axi) {
  if (r_offered_ && axi.r_ready) {
    r_offered_ = false;
    ++progress_;
    if (axi.r_last) {
      free_.push(reads_[r_id_].pop());
      if (reads_[r_id_].count == 0) read_ids_ &= ~(1u << r_id_);
      in_burst_ = false;
    }
  }
  if (b_offered_ && axi.b_ready) {
    b_offered_ = false;
    ++progress_;
    free_.push(writes_[b_id_].pop());
    if (writes_[b_id_].count == 0) write_ids_ &= ~(1u << b_id_);
  }
  if (ar_ready_ && axi.ar_valid) take_address(axi, false);
  if (aw_ready_ && axi.aw_valid) take_address(axi, true);
  if (w_ready_ && axi.w_valid) take_beat(axi);
  if (beats_complete_ && write_addresses_.count > 0) issue_write();
  if (reads_to_issue_.count > 0 && wild_chance(70)) issue_reads();
}

std::uint32_t AxiMemory::response(std::uint32_t address, std::uint32_t bytes, bool write) {
  const bool outside = std::uint64_t{address} + bytes > store_.size();
  const bool refused = address < refuse_to_ && address + bytes > refuse_from_;
  std::uint64_t& fails = write ? fail_write_ : fail_read_;
  const bool failed = fails != 0 && --fails == 0;
  return outside || refused ? kDecodeError : failed ? kSlaveError : kOkay;
}

void AxiMemory::take_address(const AxiSignals& axi, bool write) {
  ++progress_;
  const std::uint8_t number = free_.pop();
  Burst& burst = bursts_[number];
  burst = Burst{};
  burst.write = write;
  burst.id = (write ? axi.aw_id : axi.ar_id) % kIds;
  burst.address = write ? axi.aw_address : axi.ar_address;
  burst.length = write ? axi.aw_length : axi.ar_length;
  const std::uint32_t first = burst.address & ~(options_.bus_bytes - 1);
  if ((first & (kBlock - 1)) + (burst.length + 1) * options_.bus_bytes > kBlock) {
    object("a burst leaves its 64 bytes");
    burst.length = 0;
  }
  burst.bytes = first + (burst.length + 1) * options_.bus_bytes - burst.address;
  burst.response = response(burst.address, burst.bytes, write);
  if (options_.wild) burst.not_before = cycle_ + random_() % kWildDelay;
  if (write) {
    write_addresses_.push(number);
  } else {
    reads_to_issue_.push(number);
    reads_[burst.id].push(number);
    read_ids_ |= 1u << burst.id;
    ++burst.waiting;  // until it is issued
  }
}

void AxiMemory::take_beat(const AxiSignals& axi) {
  ++progress_;
  if (beat_count_ == kMaxBeats) return object("too many beats in a write");
  beats_[beat_count_] = axi.w_data;
  beat_strobes_[beat_count_] = lost() ? 0 : axi.w_strobes;
  ++beat_count_;
  beats_complete_ = axi.w_last;
}

// The beats into the burst's aligned block; from then on its address and size are those of what the
// strobes let through.
void AxiMemory::assemble_write() {
  Burst& burst = bursts_[write_addresses_.front()];
  if (beat_count_ != burst.length + 1) object("a write has not as many beats as its address says");
  const std::uint32_t block = burst.address & ~(kBlock - 1);
  std::uint32_t place = burst.address & (kBlock - 1) & ~(options_.bus_bytes - 1);
  for (std::uint32_t i = 0; i < std::min(beat_count_, burst.length + 1); ++i) {
    std::memcpy(burst.data.data() + place, beats_[i].data(), options_.bus_bytes);
    burst.strobes |= beat_strobes_[i] << place;
    place += options_.bus_bytes;
  }
  const std::uint32_t skipped = burst.address & (kBlock - 1);
  if (skipped > 0 && (burst.strobes & ((std::uint64_t{1} << skipped) - 1)) != 0) {
    object("a write has strobes before its address");
  }
  burst.bytes = 0;
  if (burst.strobes != 0) {
    const auto first = static_cast<std::uint32_t>(std::countr_zero(burst.strobes));
    burst.bytes = kBlock - static_cast<std::uint32_t>(std::countl_zero(burst.strobes)) - first;
    burst.address = block + first;
  }
}

void AxiMemory::issue_write() {
  const std::uint8_t number = write_addresses_.front();
  Burst& burst = bursts_[number];
  if (!assembled_) {
    assemble_write();
    assembled_ = true;
  }
  if (burst.response == kOkay) {
    while (burst.issued < burst.bytes) {
      if (!hand_on(number)) return;
    }
    if (!options_.wild) put_into_store(burst);
  }
  write_addresses_.pop();
  writes_[burst.id].push(number);
  write_ids_ |= 1u << burst.id;
  beat_count_ = 0;
  beats_complete_ = assembled_ = false;
  carried_out(burst);
}

void AxiMemory::issue_reads() {
  std::uint32_t commands = options_.commands_per_cycle;
  while (commands > 0 && reads_to_issue_.count > 0) {
    const std::uint8_t number = reads_to_issue_.front();
    Burst& burst = bursts_[number];
    if (burst.response != kDecodeError) {
      const std::uint32_t from = burst.issued;
      if (!hand_on(number)) return;
      --commands;
      store_.read(model::Address(burst.address + from), burst.data.data() + from,
                  burst.issued - from);
      if (burst.issued < burst.bytes) continue;
    }
    --burst.waiting;
    reads_to_issue_.pop();
    carried_out(burst);
  }
}

// The next access of a burst, to memory.
bool AxiMemory::hand_on(std::uint8_t number) {
  Burst& burst = bursts_[number];
  const model::Address at(burst.address + burst.issued);
  if (!memory_.ready(at, burst.write)) return false;
  const auto room = access_bytes_ - static_cast<std::uint32_t>(at.value % access_bytes_);
  const std::uint32_t size = std::min(burst.bytes - burst.issued, room);
  memory_.accept({at, size, burst.write, number}, now_);
  burst.issued += size;
  ++burst.waiting;
  ++progress_;
  return true;
}

void AxiMemory::carried_out(const Burst& burst) {
  if (observer_ && burst.response != kDecodeError) {
    observer_->burst(burst.address, burst.bytes, burst.write, burst.id);
  }
}

void AxiMemory::put_into_store(const Burst& burst) {
  if (burst.bytes == 0) return;
  const std::uint32_t place = burst.address & (kBlock - 1);
  const std::uint64_t strobes = burst.strobes >> place;
  if (static_cast<std::uint32_t>(std::popcount(strobes)) == burst.bytes) {
    store_.write(model::Address(burst.address), burst.data.data() + place, burst.bytes);
    return;
  }
  for (std::uint32_t i = 0; i < burst.bytes; ++i) {
    if (strobes >> i & 1) {
      store_.write(model::Address(burst.address + i), burst.data.data() + place + i, 1);
    }
  }
}

// An ID whose oldest burst has come back, the others in turn behind the one before.
bool AxiMemory::choose(std::uint32_t ids, const std::array<Ring, kIds>& rings, std::uint32_t& id) {
  const std::uint32_t behind = (2u << id) - 1;
  for (std::uint32_t set : {ids & ~behind, ids & behind}) {
    for (; set != 0; set &= set - 1) {
      const auto at = static_cast<std::uint32_t>(std::countr_zero(set));
      const Burst& burst = bursts_[rings[at].front()];
      if (burst.waiting != 0 || cycle_ < burst.not_before || !wild_chance(60)) continue;
      id = at;
      return true;
    }
  }
  return false;
}

void AxiMemory::offer_read(AxiSignals& axi) {
  axi.r_valid = false;
  if (options_.wild || !in_burst_) {
    if (read_ids_ == 0 || !choose(read_ids_, reads_, r_id_)) return;
  }
  in_burst_ = true;
  Burst& burst = bursts_[reads_[r_id_].front()];
  if (burst.beat > burst.length) return;  // its last beat was lost
  const std::uint32_t beat = burst.beat++;
  if (lost()) return;
  // The first beat may begin in its middle.
  const std::uint32_t skipped = burst.address & (options_.bus_bytes - 1);
  const std::uint32_t from = beat * options_.bus_bytes;
  axi.r_data = {};
  auto* to = reinterpret_cast<std::uint8_t*>(axi.r_data.data());
  if (beat == 0) {
    std::memcpy(to + skipped, burst.data.data(), options_.bus_bytes - skipped);
  } else {
    std::memcpy(to, burst.data.data() + from - skipped, options_.bus_bytes);
  }
  axi.r_valid = r_offered_ = true;
  axi.r_id = r_id_;
  axi.r_response = burst.response;
  axi.r_last = beat == burst.length;
}

void AxiMemory::offer_response(AxiSignals& axi) {
  axi.b_valid = false;
  if (write_ids_ == 0 || !choose(write_ids_, writes_, b_id_)) return;
  const Burst& burst = bursts_[writes_[b_id_].front()];
  if (options_.wild && burst.response == kOkay) put_into_store(burst);
  axi.b_valid = b_offered_ = true;
  axi.b_id = b_id_;
  axi.b_response = burst.response;
}

}  // namespace fasttree::rtl
