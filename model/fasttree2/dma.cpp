// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/dma.h"

#include <algorithm>
#include <cassert>

namespace fasttree::model::ft2 {

namespace {
enum Reason : std::size_t { kMemory };
}  // namespace

Port::Port(std::string purpose, std::uint32_t buffer_bytes, std::uint32_t beat_bytes)
    : purpose_(std::move(purpose)),
      beat_bytes_(beat_bytes),
      ring_(std::max<std::size_t>(buffer_bytes / beat_bytes, 2)) {}

void ReadPort::request(Address address, std::uint32_t bytes) {
  assert(ready() && bytes <= beat_bytes_);
  Beat& beat = ring_[wrap(head_ + held_++)];
  beat.address = address;
  beat.bytes = bytes;
  beat.arrived = false;
}

void ReadPort::pop() {
  assert(valid());
  head_ = wrap(head_ + 1);
  --held_;
  --issued_;
}

bool WritePort::ready(Address address, std::uint32_t bytes) const {
  if (written_this_cycle_) return false;
  const std::uint64_t first = address.value / beat_bytes_;
  const std::uint64_t last = (address.value + bytes - 1) / beat_bytes_;
  return last - first + 1 <= free_beats();
}

void WritePort::write(Address address, const std::uint8_t* data, std::uint32_t bytes) {
  assert(ready(address, bytes));
  while (bytes > 0) {
    const auto room = static_cast<std::uint32_t>(beat_bytes_ - address.value % beat_bytes_);
    const std::uint32_t now = std::min(room, bytes);
    Beat& beat = ring_[wrap(head_ + held_++)];
    beat.address = address;
    beat.bytes = now;
    std::copy_n(data, now, beat.data.begin());
    address += Address(now);
    data += now;
    bytes -= now;
  }
  written_this_cycle_ = true;
}

Dma::Dma(Memory& memory, ByteStore& store, std::uint64_t clock_period_ps)
    : Unit("dma", "bus", {"memory"}),
      memory_(memory),
      store_(store),
      period_ps_(clock_period_ps),
      beat_bytes_(std::min(memory.traits().access_bytes, kMaxBeatBytes)),
      channels_(memory.traits().channels) {}

ReadPort& Dma::add_read(const std::string& purpose, std::uint32_t buffer_bytes) {
  reads_.push_back(std::make_unique<ReadPort>(purpose, buffer_bytes, beat_bytes_));
  return *reads_.back();
}

WritePort& Dma::add_write(const std::string& purpose, std::uint32_t buffer_bytes) {
  writes_.push_back(std::make_unique<WritePort>(purpose, buffer_bytes, beat_bytes_));
  return *writes_.back();
}

bool Dma::issue(std::size_t port) {
  const bool write = port >= reads_.size();
  Port& p = write ? static_cast<Port&>(*writes_[port - reads_.size()]) : *reads_[port];
  if (!p.pending()) return false;
  const std::size_t slot = p.wrap(p.head_ + p.issued_);
  Beat& beat = p.ring_[slot];
  if (!memory_.ready(beat.address, write)) return false;
  const auto tag = static_cast<std::uint32_t>(port << 16 | slot);
  memory_.accept({beat.address, beat.bytes, write, tag}, Picoseconds(cycle_ * period_ps_));
  // Accesses to the same bytes take effect in the order they are accepted, so the bytes move here;
  // a reader sees them when the completion says so.
  if (write) {
    store_.write(beat.address, beat.data.data(), beat.bytes);
    p.head_ = p.wrap(p.head_ + 1);
    --p.held_;
  } else {
    store_.read(beat.address, beat.data.data(), beat.bytes);
    ++p.issued_;
  }
  p.moved_bytes_ += beat.bytes;
  moved_bytes_ += beat.bytes;
  return true;
}

void Dma::tick() {
  ++cycle_;
  memory_.advance(Picoseconds(cycle_ * period_ps_));
  bool moved = false;
  MemoryCompletion completion;
  while (memory_.take(completion)) {
    moved = true;
    if (!completion.write)
      reads_[completion.tag >> 16]->ring_[completion.tag & 0xffff].arrived = true;
  }
  const std::size_t ports = reads_.size() + writes_.size();
  std::uint32_t budget = channels_;
  bool waiting = false;
  std::size_t port = next_port_;
  for (std::size_t i = 0; i < ports && budget > 0; ++i) {
    if (issue(port)) {
      --budget;
      moved = true;
      next_port_ = port + 1 == ports ? 0 : port + 1;
    } else {
      const Port& p = port >= reads_.size()
                          ? static_cast<const Port&>(*writes_[port - reads_.size()])
                          : *reads_[port];
      waiting |= p.pending();
    }
    port = port + 1 == ports ? 0 : port + 1;
  }
  for (auto& w : writes_) w->written_this_cycle_ = false;
  if (moved) {
    busy();
  } else if (waiting) {
    stalled(kMemory);
  } else {
    idle();
  }
}

bool Dma::done() const {
  for (const auto& r : reads_) {
    if (!r->empty()) return false;
  }
  for (const auto& w : writes_) {
    if (!w->drained()) return false;
  }
  return memory_.idle();
}

std::string Dma::waits_for() const {
  std::string text;
  const auto note = [&](const Port& p, bool write) {
    if (!p.pending()) return;
    text += text.empty() ? "" : ", ";
    text += "the memory to accept a " + std::string(write ? "write" : "read") + " of " + p.purpose_;
  };
  for (const auto& r : reads_) note(*r, false);
  for (const auto& w : writes_) note(*w, true);
  if (text.empty() && !memory_.idle()) text = "memory: " + memory_.waits_for();
  return text;
}

}  // namespace fasttree::model::ft2
