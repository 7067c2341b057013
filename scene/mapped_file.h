// SPDX-License-Identifier: Apache-2.0
// A whole file as read-only memory, without copying it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "fasttree/status.h"

namespace fasttree::scene {

/// A file mapped for reading; unmapped with the last owner. Thread-safe: it never changes.
///
/// The size is taken once, when the file is opened, and every reader checks against it. A file that
/// another program shortens while it is mapped can no longer be read where it was cut (the system
/// raises SIGBUS there); `still_whole` notices that after the fact.
class MappedFile {
 public:
  /// Maps the file. io_error: it cannot be opened, is not a regular file, or cannot be mapped.
  static Result<std::shared_ptr<const MappedFile>> open(const std::string& path);

  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// All bytes of the file; empty for an empty file.
  std::span<const std::byte> bytes() const { return {data_, size_}; }

  /// Whether the file is still as long as when it was mapped.
  bool still_whole() const;

 private:
  MappedFile(int descriptor, const std::byte* data, std::size_t size)
      : descriptor_(descriptor), data_(data), size_(size) {}

  int descriptor_;
  const std::byte* data_;
  std::size_t size_;
};

}  // namespace fasttree::scene
