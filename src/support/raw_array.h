// SPDX-License-Identifier: Apache-2.0
// An array whose elements are not touched before they are written, and whose memory is kept.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "support/large_memory.h"

namespace fasttree {

/// Aligned to 64 bytes. Growing loses the content. For types without constructors only.
template <typename T>
class RawArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  RawArray() = default;
  RawArray(RawArray&& other) noexcept { swap(other); }
  RawArray& operator=(RawArray&& other) noexcept {
    swap(other);
    return *this;
  }
  ~RawArray() { release(); }

  /// The content is void afterwards.
  void resize_and_forget(std::size_t size) {
    if (size > capacity_) {
      // A little more, so that a scene that grows slowly does not allocate in every frame.
      const std::size_t capacity = size + size / 8;
      T* const fresh = static_cast<T*>(allocate_large(capacity * sizeof(T)));
      release();
      data_ = fresh;
      capacity_ = capacity;
    }
    size_ = size;
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  void release() {
    if (data_ != nullptr) release_large(data_, capacity_ * sizeof(T));
  }
  void swap(RawArray& other) {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace fasttree
