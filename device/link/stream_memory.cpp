// SPDX-License-Identifier: Apache-2.0
#include "device/link/stream_memory.h"

#include <new>

#include "support/large_memory.h"

namespace fasttree::device {

StreamMemory StreamMemory::allocate(std::uint64_t bytes) {
  StreamMemory memory;
  try {
    const std::size_t size = bytes;
    auto* begin = static_cast<std::byte*>(allocate_large(size > 0 ? size : 1));
    memory.memory_ = std::shared_ptr<std::byte[]>(
        begin, [size](std::byte* p) { release_large(p, size > 0 ? size : 1); });
    memory.size_ = size;
  } catch (const std::bad_alloc&) {
    memory = StreamMemory();
  }
  return memory;
}

}  // namespace fasttree::device
