// SPDX-License-Identifier: Apache-2.0
// The bytes of off-chip memory.
#pragma once

#include <cassert>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "model/kernel/quantities.h"

namespace fasttree::model {

/// Flat, little-endian as the host. Sized once, before a run.
class ByteStore {
 public:
  explicit ByteStore(std::uint64_t bytes) : bytes_(bytes) {}

  std::uint64_t size() const { return bytes_.size(); }
  void read(Address from, void* to, std::size_t count) const {
    assert(from.value + count <= bytes_.size());
    std::memcpy(to, bytes_.data() + from.value, count);
  }
  void write(Address to, const void* from, std::size_t count) {
    assert(to.value + count <= bytes_.size());
    std::memcpy(bytes_.data() + to.value, from, count);
  }
  std::span<const std::uint8_t> view(Address from, std::size_t count) const {
    return std::span(bytes_).subspan(from.value, count);
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace fasttree::model
