// SPDX-License-Identifier: Apache-2.0
// Memory for large arrays in huge pages where the system has them: a rebuild touches all of it, and
// with pages of 4 KB the first touch costs more than the work (docs/performance.md).
#pragma once

#include <cstddef>

namespace fasttree {

inline constexpr std::size_t kHugePage = std::size_t{2} << 20;

/// Aligned to 64 bytes; the content is void. Arrays of many pages have huge pages of their own,
/// those of a few share some. Thread-safe. Throws std::bad_alloc.
void* allocate_large(std::size_t bytes);

/// `bytes` as they were asked for. Pages that hold nothing any more go back to the system.
void release_large(void* memory, std::size_t bytes) noexcept;

}  // namespace fasttree
