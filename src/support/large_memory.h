// SPDX-License-Identifier: Apache-2.0
// Memory for large arrays in huge pages where the system has them: a rebuild touches all of it, and
// with pages of 4 KB the first touch costs more than the work (docs/performance.md).
#pragma once

#include <cstddef>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace fasttree {

inline constexpr std::size_t kHugePage = std::size_t{2} << 20;

/// Alignment of an allocation of so many bytes; the same for both functions below.
inline std::align_val_t large_alignment(std::size_t bytes) {
  return std::align_val_t{bytes >= 2 * kHugePage ? kHugePage : 64};
}

/// Throws std::bad_alloc. The content is void.
inline void* allocate_large(std::size_t bytes) {
  void* const memory = ::operator new(bytes, large_alignment(bytes));
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  // Advice only: whole pages inside the allocation, and a refusal changes nothing but time.
  if (bytes >= 2 * kHugePage) (void)madvise(memory, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
  return memory;
}

inline void release_large(void* memory, std::size_t bytes) {
  ::operator delete(memory, large_alignment(bytes));
}

}  // namespace fasttree
