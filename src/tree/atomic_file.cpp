// SPDX-License-Identifier: Apache-2.0
#include "tree/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <utility>

namespace fasttree {
namespace {

std::string error_text(int error) {
  return std::generic_category().message(error);
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

// Makes the rename itself durable. The file is whole and in place by then, so a folder that cannot
// be flushed (some network file systems) is no failure.
void flush_folder(const std::string& path) {
  const int folder = ::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  ::fsync(folder);
  ::close(folder);
}

}  // namespace

Result<AtomicFile> AtomicFile::create(const std::string& path) {
  struct stat existing {};
  if (::stat(path.c_str(), &existing) == 0 && !S_ISREG(existing.st_mode)) {
    return Status(StatusCode::io_error, path + ": not a regular file, so it is not replaced");
  }
  // The name only has to be new; O_EXCL makes sure of it.
  auto salt =
      static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  salt ^= static_cast<std::uint64_t>(::getpid()) << 40;
  int error = EEXIST;
  for (int attempt = 0; attempt < 100 && error == EEXIST; ++attempt, ++salt) {
    std::string temporary = path + ".tmp-" + std::to_string(salt);
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) return AtomicFile(descriptor, path, std::move(temporary));
    error = errno;
  }
  const bool full = error == ENOSPC || error == EDQUOT;
  return Status(full ? StatusCode::resource_limit : StatusCode::io_error,
                path + ": cannot create a file in its folder: " + error_text(error));
}

AtomicFile::AtomicFile(int descriptor, std::string path, std::string temporary)
    : descriptor_(descriptor), path_(std::move(path)), temporary_(std::move(temporary)) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, std::string())) {}

AtomicFile::~AtomicFile() {
  discard();
}

void AtomicFile::discard() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

Status AtomicFile::failed(const char* what, int error) const {
  if (error == ENOSPC || error == EDQUOT || error == EFBIG) {
    return {StatusCode::resource_limit, path_ + ": no room to write it (" + error_text(error) +
                                            "); free some space or write elsewhere"};
  }
  return {StatusCode::io_error, path_ + ": cannot " + what + ": " + error_text(error)};
}

Status AtomicFile::write(std::span<const std::byte> data) {
  // One call writes at most about 2 GiB on Linux; smaller pieces keep signals responsive.
  constexpr std::size_t kPiece = std::size_t{64} << 20;
  while (!data.empty()) {
    const ssize_t written = ::write(descriptor_, data.data(), std::min(data.size(), kPiece));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return failed("write", errno);
    data = data.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Status AtomicFile::commit() {
  if (::fsync(descriptor_) != 0) return failed("flush", errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) return failed("close", errno);
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0)
    return failed("rename into place", errno);
  temporary_.clear();
  flush_folder(path_);
  return {};
}

}  // namespace fasttree
