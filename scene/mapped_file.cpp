// SPDX-License-Identifier: Apache-2.0
#include "scene/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <limits>
#include <system_error>

namespace fasttree::scene {
namespace {

// std::generic_category().message and not strerror, which is not thread-safe.
Status file_error(const std::string& path, const char* what, int error) {
  return {StatusCode::io_error,
          path + ": " + what + ": " + std::generic_category().message(error) + "."};
}

}  // namespace

Result<std::shared_ptr<const MappedFile>> MappedFile::open(const std::string& path) {
  // O_NONBLOCK: opening a named pipe must not wait for a writer.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return file_error(path, "cannot open the file", errno);

  struct stat info = {};
  if (::fstat(descriptor, &info) != 0) {
    const int error = errno;
    ::close(descriptor);
    return file_error(path, "cannot read the file's size", error);
  }
  if (!S_ISREG(info.st_mode)) {
    ::close(descriptor);
    return Status(StatusCode::io_error,
                  path + ": is not a regular file. Name a mesh file, not a folder or a pipe.");
  }
  const auto file_size = static_cast<std::uint64_t>(info.st_size);
  if (file_size > std::numeric_limits<std::size_t>::max()) {
    ::close(descriptor);
    return Status(StatusCode::resource_limit, path + ": the file does not fit in address space.");
  }

  const auto size = static_cast<std::size_t>(file_size);
  void* data = nullptr;
  if (size > 0) {  // mmap refuses an empty range
    data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (data == MAP_FAILED) {
      const int error = errno;
      ::close(descriptor);
      return file_error(path, "cannot map the file", error);
    }
  }
  return std::shared_ptr<const MappedFile>(
      new MappedFile(descriptor, static_cast<const std::byte*>(data), size));
}

MappedFile::~MappedFile() {
  if (size_ > 0) ::munmap(const_cast<std::byte*>(data_), size_);
  ::close(descriptor_);
}

bool MappedFile::still_whole() const {
  struct stat info = {};
  return ::fstat(descriptor_, &info) == 0 && static_cast<std::uint64_t>(info.st_size) >= size_;
}

}  // namespace fasttree::scene
