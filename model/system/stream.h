// SPDX-License-Identifier: Apache-2.0
// What a unit has at its bus port: a reader that runs ahead of it through memory, and writers that
// gather bytes into blocks. They are part of the unit that owns them and work in its tick.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "model/system/bus.h"

namespace fasttree::model {

/// Reads a run of memory in order, asking for bursts while there is room for them at the port.
class StreamReader {
 public:
  explicit StreamReader(BusPort& port, std::uint32_t burst_bytes)
      : port_(&port), burst_bytes_(burst_bytes) {}

  void start(Address from, std::uint64_t bytes, Purpose purpose) {
    next_ = from.value;
    end_ = from.value + bytes;
    left_ = bytes;
    purpose_ = purpose;
    asked_ = port_->data.taken();
  }

  /// Asks for the next burst where it fits. Once a cycle.
  void tick() {
    if (next_ == end_ || !port_->requests.ready()) return;
    const auto size = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(end_ - next_, burst_bytes_ - (next_ & (burst_bytes_ - 1))));
    if (asked_ + size - port_->data.taken() > port_->data.capacity()) return;
    BusRequest request;
    request.address = Address(next_);
    request.bytes = size;
    request.purpose = purpose_;
    port_->requests.push(request);
    next_ += size;
    asked_ += size;
  }

  std::uint64_t left() const { return left_; }  ///< bytes not taken yet
  std::size_t available() const { return port_->data.visible(); }
  void take(void* to, std::size_t bytes) {
    port_->data.pop(to, bytes);
    left_ -= bytes;
  }
  const std::string& port_name() const { return port_->name(); }

 private:
  BusPort* port_;
  std::uint32_t burst_bytes_;
  std::uint64_t next_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t left_ = 0;
  std::uint64_t asked_ = 0;  ///< in the count of ByteFifo::taken
  Purpose purpose_ = Purpose::scene;
};

/// Gathers bytes for consecutive addresses and writes them in aligned blocks.
class BlockWriter {
 public:
  void start(BusPort& port, std::uint32_t block_bytes, Address at, Purpose purpose) {
    start(port.requests, block_bytes, at, purpose);
  }
  /// Where blocks wait elsewhere before they go to the port.
  void start(Queue<BusRequest>& requests, std::uint32_t block_bytes, Address at, Purpose purpose) {
    requests_ = &requests;
    block_bytes_ = block_bytes;
    next_ = at.value;
    purpose_ = purpose;
    request_.bytes = 0;
  }

  Address next() const { return Address(next_); }
  bool holds() const { return request_.bytes > 0; }

  /// Requests that put() makes at most for so many bytes.
  std::size_t requests_for(std::size_t bytes) const {
    return ((next_ & (block_bytes_ - 1)) + bytes) >> std::countr_zero(block_bytes_);
  }
  bool ready(std::size_t bytes) const { return requests_->ready(requests_for(bytes)); }
  void put(const void* from, std::size_t bytes) {
    const auto* source = static_cast<const std::uint8_t*>(from);
    while (bytes > 0) {
      if (request_.bytes == 0) request_.address = Address(next_);
      const std::size_t room = block_bytes_ - (next_ & (block_bytes_ - 1));
      const std::size_t part = std::min(room, bytes);
      std::memcpy(request_.data.data() + request_.bytes, source, part);
      request_.bytes += static_cast<std::uint32_t>(part);
      next_ += part;
      source += part;
      bytes -= part;
      if (part == room) flush();
    }
  }

  /// Writes what is held. Needs room for one request where something is.
  void flush() {
    if (request_.bytes == 0) return;
    request_.write = true;
    request_.purpose = purpose_;
    requests_->push(request_);
    request_.bytes = 0;
  }

 private:
  Queue<BusRequest>* requests_ = nullptr;
  std::uint32_t block_bytes_ = kMaxRequestBytes;
  std::uint64_t next_ = 0;
  Purpose purpose_ = Purpose::scene;
  BusRequest request_;
};

}  // namespace fasttree::model
