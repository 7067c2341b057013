// SPDX-License-Identifier: Apache-2.0
// Writing a file so that its name never shows half of it: write to a temporary name in the same
// folder, flush, rename.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "fasttree/status.h"

namespace fasttree {

/// One file being written. Destroyed without commit(), it removes what it wrote and leaves `path`
/// as it was.
class AtomicFile {
 public:
  /// io_error where the folder does not take a new file, or `path` is there already and is not a
  /// regular file (a folder, a device).
  static Result<AtomicFile> create(const std::string& path);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  /// Appends. resource_limit: the disk, a quota or a limit on file sizes is full; else io_error.
  Status write(std::span<const std::byte> data);

  /// Flushes to the disk and renames into place.
  Status commit();

 private:
  AtomicFile(int descriptor, std::string path, std::string temporary);
  Status failed(const char* what, int error) const;
  void discard();

  int descriptor_ = -1;
  std::string path_;
  std::string temporary_;  ///< empty once it is renamed or removed
};

}  // namespace fasttree
