// SPDX-License-Identifier: Apache-2.0
// Ports to off-chip memory, and the unit that carries their accesses to its channels.
//
// A port is a small ring of accesses in order: a reading port is the prefetch buffer of a stream, a
// writing port its write buffer. Ports know nothing of each other, so what is written through one
// and read through another has to be kept apart by its users: a read is asked for only when the
// write was accepted (WritePort::drained), and the memory keeps the order from there.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/kernel/quantities.h"
#include "model/kernel/unit.h"
#include "model/memory/byte_store.h"
#include "model/memory/memory.h"

namespace fasttree::model::ft2 {

inline constexpr std::uint32_t kMaxBeatBytes = 64;

/// One access of a port, with its bytes.
struct Beat {
  Address address;
  std::uint32_t bytes = 0;
  bool arrived = false;  ///< reading ports: the data is here
  std::array<std::uint8_t, kMaxBeatBytes> data;
};

class Dma;

/// A ring of accesses. The owner pushes at one end; the Dma issues them in order.
class Port {
 public:
  const std::string& purpose() const { return purpose_; }
  std::uint64_t moved_bytes() const { return moved_bytes_; }
  std::size_t free_beats() const { return ring_.size() - held_; }
  /// Largest access: a granule of the memory, or less. Accesses cross no multiple of it.
  std::uint32_t beat_bytes() const { return beat_bytes_; }

 protected:
  friend class Dma;
  Port(std::string purpose, std::uint32_t buffer_bytes, std::uint32_t beat_bytes);

  std::size_t wrap(std::size_t i) const { return i >= ring_.size() ? i - ring_.size() : i; }
  bool pending() const { return issued_ < held_; }

  std::string purpose_;
  std::uint32_t beat_bytes_;
  std::vector<Beat> ring_;
  std::size_t head_ = 0;
  std::size_t held_ = 0;
  std::size_t issued_ = 0;  ///< of those held, from the head
  std::uint64_t moved_bytes_ = 0;
};

/// Asks for bytes ahead of their use, and hands them out in order.
class ReadPort : public Port {
 public:
  ReadPort(std::string purpose, std::uint32_t buffer_bytes, std::uint32_t beat_bytes)
      : Port(std::move(purpose), buffer_bytes, beat_bytes) {}

  bool ready() const { return held_ < ring_.size(); }
  void request(Address address, std::uint32_t bytes);
  bool valid() const { return held_ > 0 && ring_[head_].arrived; }
  const Beat& front() const { return ring_[head_]; }
  void pop();
  bool empty() const { return held_ == 0; }
};

/// Takes bytes to be written. One write() a cycle.
class WritePort : public Port {
 public:
  WritePort(std::string purpose, std::uint32_t buffer_bytes, std::uint32_t beat_bytes)
      : Port(std::move(purpose), buffer_bytes, beat_bytes) {}

  /// Room for a line of `bytes` that starts at `address`, and not written to in this cycle.
  bool ready(Address address, std::uint32_t bytes) const;
  void write(Address address, const std::uint8_t* data, std::uint32_t bytes);
  /// Everything written so far was accepted by the memory: whoever reads now, reads it.
  bool drained() const { return held_ == 0; }

 private:
  friend class Dma;
  bool written_this_cycle_ = false;
};

/// The crossbar between ports and channels: round robin over the ports, at most one access a port
/// and one a channel in a cycle.
class Dma : public Unit {
 public:
  Dma(Memory& memory, ByteStore& store, std::uint64_t clock_period_ps);

  ReadPort& add_read(const std::string& purpose, std::uint32_t buffer_bytes);
  WritePort& add_write(const std::string& purpose, std::uint32_t buffer_bytes);
  std::uint32_t beat_bytes() const { return beat_bytes_; }

  /// Begins the cycle: hands out what has arrived, and issues what was asked for before it.
  void tick() override;
  bool done() const override;
  std::string waits_for() const override;

  const std::vector<std::unique_ptr<ReadPort>>& read_ports() const { return reads_; }
  const std::vector<std::unique_ptr<WritePort>>& write_ports() const { return writes_; }
  std::uint64_t moved_bytes() const { return moved_bytes_; }
  std::uint64_t cycle() const { return cycle_; }

 private:
  bool issue(std::size_t port);

  Memory& memory_;
  ByteStore& store_;
  std::uint64_t period_ps_;
  std::uint32_t beat_bytes_;
  std::uint32_t channels_;
  std::vector<std::unique_ptr<ReadPort>> reads_;
  std::vector<std::unique_ptr<WritePort>> writes_;
  std::size_t next_port_ = 0;
  std::uint64_t cycle_ = 0;
  std::uint64_t moved_bytes_ = 0;
};

}  // namespace fasttree::model::ft2
