// SPDX-License-Identifier: Apache-2.0
#include "support/large_memory.h"

#include <cstdint>
#include <mutex>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace fasttree {
namespace {

constexpr std::size_t kLine = 64;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// A sanitizer sees past the end of an array only where each is an allocation of its own.
constexpr bool kShare = false;
#else
constexpr bool kShare = true;
#endif

// From here on an array has pages of its own, and below the second it is not worth the trouble.
constexpr std::size_t kLeastAlone = kHugePage / 2;
constexpr std::size_t kLeastShared = 2048;

constexpr bool alone(std::size_t bytes) {
  return bytes >= kLeastAlone;
}
constexpr bool shared(std::size_t bytes) {
  return kShare && bytes >= kLeastShared && bytes < kLeastAlone;
}

constexpr std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

void* huge_pages(std::size_t bytes) {
  void* const memory = ::operator new (bytes, std::align_val_t{kHugePage});
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  (void)madvise(memory, bytes, MADV_HUGEPAGE);  // advice: a refusal changes nothing but time
#endif
  return memory;
}

// One huge page that arrays share, taken from its front to its end. It is given back when the last
// of them is: working memory comes and goes as a whole.
struct SharedPage {
  std::size_t arrays = 0;
  std::size_t used = kLine;  // this header
};
static_assert(sizeof(SharedPage) <= kLine);

std::mutex shared_mutex;
SharedPage* filling = nullptr;  // where the next array goes, unless it does not fit

void* allocate_shared(std::size_t bytes) {
  const std::size_t size = rounded_up(bytes, kLine);
  const std::lock_guard lock(shared_mutex);
  if (filling == nullptr || filling->used + size > kHugePage) {
    filling = new (huge_pages(kHugePage)) SharedPage;
  }
  void* const memory = reinterpret_cast<char*>(filling) + filling->used;
  filling->used += size;
  ++filling->arrays;
  return memory;
}

void release_shared(void* memory) noexcept {
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  auto* const page = reinterpret_cast<SharedPage*>(address / kHugePage * kHugePage);
  const std::lock_guard lock(shared_mutex);
  if (--page->arrays != 0) return;
  if (page == filling) filling = nullptr;
  ::operator delete (page, std::align_val_t{kHugePage});
}

}  // namespace

void* allocate_large(std::size_t bytes) {
  if (shared(bytes)) return allocate_shared(bytes);
  if (kShare && alone(bytes)) return huge_pages(rounded_up(bytes, kHugePage));
  return ::operator new (bytes, std::align_val_t{kLine});
}

void release_large(void* memory, std::size_t bytes) noexcept {
  if (shared(bytes)) return release_shared(memory);
  ::operator delete (memory, std::align_val_t{kShare && alone(bytes) ? kHugePage : kLine});
}

}  // namespace fasttree
