// SPDX-License-Identifier: Apache-2.0
// Any bytes as a tree file: loading and mapping agree, the verifier stands whatever comes, and a
// tree that passes it goes to the device image and back unchanged.
//
// Run: tree_file_fuzz -max_len=4096 NEW_FINDS fuzz/corpus/tree
//
// Almost every mutation would end at the checksum. So each input is tried twice: as it is, and with
// the header's sizes, hash and checksum made right, which lets nodes and ids of any content in.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "fasttree/device_image.h"
#include "fasttree/tree_file.h"
#include "fasttree/verify.h"
#include "tree/xxh3.h"

namespace {

using namespace fasttree;

// A file in memory under a name that can be opened.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::byte> content)
      : descriptor_(::memfd_create("tree", MFD_CLOEXEC)) {
    if (descriptor_ < 0) std::abort();
    while (!content.empty()) {
      const ssize_t written = ::write(descriptor_, content.data(), content.size());
      if (written <= 0) std::abort();
      content = content.subspan(static_cast<std::size_t>(written));
    }
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(descriptor_); }

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

void expect(bool fact) {
  if (!fact) std::abort();
}

bool same(const Tree& a, const Tree& b) {
  return std::memcmp(&a.info().bounds, &b.info().bounds, sizeof(Box3)) == 0 &&
         std::ranges::equal(a.nodes(), b.nodes()) && std::ranges::equal(a.ids(), b.ids());
}

void use(const Tree& tree) {
  const bool good = verify(tree).ok;
  const Result<DeviceImage> image = device_image_from_tree(tree);
  expect(image.ok() || !good);
  if (!image.ok()) return;
  const Result<Tree> again = tree_from_device_image(image.value());
  expect(again.ok() || !good);
  if (again.ok()) expect(same(again.value(), tree));
}

void try_file(std::span<const std::byte> content) {
  const MemoryFile file(content);
  const Result<Tree> loaded = load_tree(file.path());
  const Result<Tree> mapped = map_tree(file.path());
  expect(loaded.ok() == mapped.ok());
  expect(loaded.status().message() == mapped.status().message());
  expect(is_tree_file(file.path()) || !loaded.ok());
  if (!loaded.ok()) return;
  expect(same(loaded.value(), mapped.value()));
  use(mapped.value());
}

constexpr std::size_t kHeaderBytes = 128;

template <typename T>
void put(std::vector<std::byte>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// Offsets as in docs/tree.md.
std::vector<std::byte> made_right(std::span<const std::byte> content) {
  std::vector<std::byte> bytes(content.begin(), content.end());
  bytes.resize(std::max(bytes.size() / 4 * 4, kHeaderBytes));
  std::uint64_t nodes = 0;
  std::memcpy(&nodes, bytes.data() + 24, sizeof nodes);
  const std::size_t payload = bytes.size() - kHeaderBytes;
  nodes = std::min<std::uint64_t>(nodes, payload / 8);
  std::memcpy(bytes.data(), "FASTTREE", 8);
  put<std::uint32_t>(bytes, 8, 1);
  put<std::uint32_t>(bytes, 12, 0x01020304);
  put<std::uint64_t>(bytes, 16, kHeaderBytes);
  put<std::uint64_t>(bytes, 24, nodes);
  put<std::uint64_t>(bytes, 32, (payload - nodes * 8) / 4);
  put<std::uint32_t>(bytes, 44, 0);
  put<std::uint16_t>(bytes, 78, 0);
  std::fill(bytes.begin() + 96, bytes.begin() + kHeaderBytes, std::byte{});
  Xxh3 tree_hash;
  tree_hash.bytes(std::span(bytes).subspan(48, 24));
  tree_hash.bytes(std::span(bytes).subspan(kHeaderBytes));
  put(bytes, 80, tree_hash.digest());
  Xxh3 checksum;
  checksum.bytes(std::span(bytes).first(88));
  checksum.bytes(std::span(bytes).subspan(96));
  put(bytes, 88, checksum.digest());
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span content(reinterpret_cast<const std::byte*>(data), size);
  try_file(content);
  try_file(made_right(content));
  return 0;
}
