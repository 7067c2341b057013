// SPDX-License-Identifier: Apache-2.0
// Memory for a stream whose size the other side has announced.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace fasttree::device {

/// Bytes that nobody has touched yet, so that they cost nothing before they come.
class StreamMemory {
 public:
  StreamMemory() = default;
  /// Null where there is not so much; the size was compared with a limit before.
  static StreamMemory allocate(std::uint64_t bytes);

  explicit operator bool() const { return memory_ != nullptr; }
  std::span<std::byte> bytes() const { return {memory_.get(), size_}; }
  const std::shared_ptr<std::byte[]>& owner() const { return memory_; }

 private:
  std::shared_ptr<std::byte[]> memory_;
  std::size_t size_ = 0;
};

}  // namespace fasttree::device
