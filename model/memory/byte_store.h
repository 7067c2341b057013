// SPDX-License-Identifier: Apache-2.0
// The bytes of off-chip memory.
#pragma once

#include <cassert>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <span>

#include "model/kernel/quantities.h"

namespace fasttree::model {

/// Flat, little-endian as the host, zero at first. Sized once, before a run; pages that are never
/// touched take no memory.
class ByteStore {
 public:
  explicit ByteStore(std::uint64_t bytes)
      : bytes_(static_cast<std::uint8_t*>(std::calloc(bytes, 1))), size_(bytes) {
    if (bytes_ == nullptr && bytes > 0) throw std::bad_alloc();
  }

  std::uint64_t size() const { return size_; }
  void read(Address from, void* to, std::size_t count) const {
    assert(from.value + count <= size_);
    if (count == 0) return;  // an empty array may have no address
    std::memcpy(to, bytes_.get() + from.value, count);
  }
  void write(Address to, const void* from, std::size_t count) {
    assert(to.value + count <= size_);
    if (count == 0) return;
    std::memcpy(bytes_.get() + to.value, from, count);
  }
  std::span<const std::uint8_t> view(Address from, std::size_t count) const {
    assert(from.value + count <= size_);
    return {bytes_.get() + from.value, count};
  }

 private:
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  std::unique_ptr<std::uint8_t[], Free> bytes_;
  std::uint64_t size_;
};

}  // namespace fasttree::model
