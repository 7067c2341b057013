// SPDX-License-Identifier: Apache-2.0
// Trees in files: a header of 128 bytes, the nodes, the triangle ids, nothing else.
#include "fasttree/tree_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <limits>
#include <new>
#include <system_error>
#include <utility>

#include "tree/atomic_file.h"
#include "tree/xxh3.h"

namespace fasttree {
namespace {

constexpr std::array<char, 8> kMagic{'F', 'A', 'S', 'T', 'T', 'R', 'E', 'E'};
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kByteOrder = 0x01020304;

// What a file begins with. Numbers are in the byte order of the machine that wrote them, so that
// nodes and ids can be mapped; byte_order says which that is.
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t byte_order = kByteOrder;
  std::uint64_t header_bytes = 0;
  std::uint64_t node_count = 0;
  std::uint64_t id_count = 0;
  std::uint64_t triangle_count = 0;
  std::array<float, 6> bounds{};  // lo, hi
  std::uint8_t profile = 0;
  std::uint8_t axes = 0;
  std::uint8_t depth = 0;
  std::array<std::uint8_t, 3> bits{};
  std::array<std::uint8_t, 2> reserved_a{};
  std::uint64_t tree_hash = 0;
  std::uint64_t checksum = 0;  // XXH3 over the whole file but these eight bytes
  std::array<std::uint8_t, 32> reserved_b{};
};
static_assert(sizeof(Header) == 128, "nodes begin at a multiple of 64");
static_assert(std::is_trivially_copyable_v<Header>);

constexpr std::uint64_t kHeaderBytes = sizeof(Header);

using Bytes = std::span<const std::byte>;

std::uint64_t checksum(const Header& header, Bytes nodes, Bytes ids) {
  const Bytes all = std::as_bytes(std::span(&header, 1));
  constexpr std::size_t kAt = offsetof(Header, checksum);
  Xxh3 hash;
  hash.bytes(all.first(kAt));
  hash.bytes(all.subspan(kAt + sizeof header.checksum));
  hash.bytes(nodes);
  hash.bytes(ids);
  return hash.digest();
}

Header header_of(const Tree& tree) {
  const TreeInfo& info = tree.info();
  const auto& [lo, hi] = info.bounds;
  Header header;
  header.header_bytes = kHeaderBytes;
  header.node_count = tree.nodes().size();
  header.id_count = tree.ids().size();
  header.triangle_count = info.triangle_count;
  header.bounds = {lo.x, lo.y, lo.z, hi.x, hi.y, hi.z};
  header.profile = static_cast<std::uint8_t>(info.profile);
  header.axes = static_cast<std::uint8_t>(info.axes);
  header.depth = info.depth;
  header.bits = info.bits;
  header.tree_hash = tree.hash();
  header.checksum = checksum(header, std::as_bytes(tree.nodes()), std::as_bytes(tree.ids()));
  return header;
}

TreeInfo info_of(const Header& header) {
  const auto& b = header.bounds;
  TreeInfo info;
  info.profile = static_cast<Profile>(header.profile);
  info.axes = static_cast<AxisSchedule>(header.axes);
  info.depth = header.depth;
  info.bits = header.bits;
  info.triangle_count = static_cast<std::uint32_t>(header.triangle_count);
  info.bounds = {{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
  return info;
}

Status bad_file(const std::string& path, const std::string& what) {
  return {StatusCode::bad_input, path + ": " + what};
}

Status io_failure(const std::string& path, const char* what, int error) {
  return {StatusCode::io_error,
          path + ": cannot " + what + ": " + std::generic_category().message(error)};
}

// A regular file opened for reading, and its size.
class InputFile {
 public:
  static Result<InputFile> open(const std::string& path) {
    // O_NONBLOCK: a pipe nobody writes to is refused below instead of being waited for.
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) return io_failure(path, "open", errno);
    InputFile file(descriptor);
    struct stat stat {};
    if (::fstat(descriptor, &stat) != 0) return io_failure(path, "open", errno);
    if (!S_ISREG(stat.st_mode)) {
      return Status(StatusCode::io_error, path + ": cannot read: not a regular file");
    }
    file.size_ = static_cast<std::uint64_t>(stat.st_size);
    return file;
  }

  InputFile(InputFile&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}
  InputFile& operator=(InputFile&&) = delete;
  ~InputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  int descriptor() const { return descriptor_; }
  std::uint64_t size() const { return size_; }

  /// Reads the next out.size() bytes.
  Status read(const std::string& path, std::span<std::byte> out) {
    constexpr std::size_t kPiece = std::size_t{64} << 20;
    while (!out.empty()) {
      const ssize_t got = ::read(descriptor_, out.data(), std::min(out.size(), kPiece));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return io_failure(path, "read", errno);
      if (got == 0) return bad_file(path, "became shorter while it was read");
      out = out.subspan(static_cast<std::size_t>(got));
    }
    return {};
  }

 private:
  explicit InputFile(int descriptor) : descriptor_(descriptor) {}

  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

// Whether a header can be read by this code and its counts agree with the size of the file. After
// it, every count is safe to allocate.
Status check_header(const std::string& path, const Header& header, std::uint64_t file_bytes) {
  if (header.magic != kMagic) {
    return bad_file(path, "not a tree file: it does not begin with FASTTREE");
  }
  if (header.byte_order != kByteOrder) {
    return bad_file(path,
                    "written on a machine with the other byte order, or damaged; build the tree "
                    "again on this machine");
  }
  if (header.version != kVersion) {
    return bad_file(path, "version " + std::to_string(header.version) + " of the format; this " +
                              "library reads version " + std::to_string(kVersion) +
                              "; build the tree again");
  }
  if (header.header_bytes != kHeaderBytes) {
    return bad_file(path, "damaged: header of " + std::to_string(header.header_bytes) +
                              " bytes, expected " + std::to_string(kHeaderBytes));
  }
  const std::uint64_t payload = file_bytes - kHeaderBytes;
  if (header.node_count > payload / sizeof(Node) ||
      header.id_count > (payload - header.node_count * sizeof(Node)) / sizeof(std::uint32_t)) {
    return bad_file(path, "truncated: " + std::to_string(file_bytes) + " bytes cannot hold " +
                              std::to_string(header.node_count) + " nodes and " +
                              std::to_string(header.id_count) + " triangle ids");
  }
  const std::uint64_t expected =
      header.node_count * sizeof(Node) + header.id_count * sizeof(std::uint32_t);
  if (payload != expected) {
    return bad_file(path, "damaged: " + std::to_string(payload - expected) +
                              " bytes too many behind the triangle ids");
  }
  return {};
}

Status check_content(const std::string& path, const Header& header, const Tree& tree) {
  const std::uint64_t found =
      checksum(header, std::as_bytes(tree.nodes()), std::as_bytes(tree.ids()));
  if (found != header.checksum) {
    return bad_file(path, "damaged: checksum " + hash_string(found) + ", expected " +
                              hash_string(header.checksum) + "; build the tree again");
  }
  // What a sound file can still get wrong is what its writer put into it.
  if (header.profile > static_cast<std::uint8_t>(kLastProfile) ||
      header.axes > static_cast<std::uint8_t>(AxisSchedule::longest)) {
    return bad_file(path, "profile " + std::to_string(header.profile) + " or axis schedule " +
                              std::to_string(header.axes) + " is not known to this library");
  }
  if (header.triangle_count > std::numeric_limits<std::uint32_t>::max()) {
    return bad_file(path, std::to_string(header.triangle_count) +
                              " triangles are more than 32-bit ids can name");
  }
  if (header.reserved_a != Header().reserved_a || header.reserved_b != Header().reserved_b) {
    return bad_file(path, "reserved bytes of the header are in use; it needs a newer library");
  }
  const std::uint64_t hash = tree.hash();
  if (hash != header.tree_hash) {
    return bad_file(path, "its tree has the hash " + hash_string(hash) + ", its header says " +
                              hash_string(header.tree_hash));
  }
  return {};
}

Result<Header> read_header(const std::string& path, InputFile& file) {
  if (file.size() < kHeaderBytes) {
    return bad_file(path, "truncated or not a tree file: " + std::to_string(file.size()) +
                              " bytes are too few for a header of " + std::to_string(kHeaderBytes));
  }
  Header header;
  if (Status s = file.read(path, std::as_writable_bytes(std::span(&header, 1))); !s.ok()) return s;
  if (Status s = check_header(path, header, file.size()); !s.ok()) return s;
  return header;
}

// A whole file in the address space, read-only.
class Mapping {
 public:
  Mapping(void* address, std::size_t size) : address_(address), size_(size) {}
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ~Mapping() { ::munmap(address_, size_); }

 private:
  void* address_;
  std::size_t size_;
};

}  // namespace

Status save_tree(const Tree& tree, const std::string& path) {
  const Header header = header_of(tree);
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return file.status();
  for (const Bytes part : {std::as_bytes(std::span(&header, 1)), std::as_bytes(tree.nodes()),
                           std::as_bytes(tree.ids())}) {
    if (Status s = file.value().write(part); !s.ok()) return s;
  }
  return file.value().commit();
}

Result<Tree> load_tree(const std::string& path) {
  Result<InputFile> opened = InputFile::open(path);
  if (!opened.ok()) return opened.status();
  InputFile& file = opened.value();
  const Result<Header> header = read_header(path, file);
  if (!header.ok()) return header.status();
  std::vector<Node> nodes;
  std::vector<std::uint32_t> ids;
  try {
    nodes.resize(header.value().node_count);
    ids.resize(header.value().id_count);
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::resource_limit, path + ": not enough memory for " +
                                                  std::to_string(file.size()) +
                                                  " bytes; map the file instead of loading it");
  }
  if (Status s = file.read(path, std::as_writable_bytes(std::span(nodes))); !s.ok()) return s;
  if (Status s = file.read(path, std::as_writable_bytes(std::span(ids))); !s.ok()) return s;
  Tree tree(info_of(header.value()), std::move(nodes), std::move(ids));
  if (Status s = check_content(path, header.value(), tree); !s.ok()) return s;
  return tree;
}

Result<Tree> map_tree(const std::string& path) {
  Result<InputFile> opened = InputFile::open(path);
  if (!opened.ok()) return opened.status();
  InputFile& file = opened.value();
  const Result<Header> header = read_header(path, file);
  if (!header.ok()) return header.status();
  void* address = ::mmap(nullptr, file.size(), PROT_READ, MAP_SHARED, file.descriptor(), 0);
  if (address == MAP_FAILED) return io_failure(path, "map", errno);
  auto mapping = std::make_shared<const Mapping>(address, file.size());
  // Pages begin at multiples of 64, so nodes and ids are aligned for their types.
  const std::byte* at = static_cast<const std::byte*>(address) + kHeaderBytes;
  const std::span nodes(reinterpret_cast<const Node*>(at), header.value().node_count);
  at += nodes.size_bytes();
  const std::span ids(reinterpret_cast<const std::uint32_t*>(at), header.value().id_count);
  Tree tree(info_of(header.value()), nodes, ids, std::move(mapping));
  if (Status s = check_content(path, header.value(), tree); !s.ok()) return s;
  return tree;
}

bool is_tree_file(const std::string& path) {
  Result<InputFile> file = InputFile::open(path);
  std::array<char, kMagic.size()> begin{};
  return file.ok() && file.value().size() >= begin.size() &&
         file.value().read(path, std::as_writable_bytes(std::span(begin))).ok() && begin == kMagic;
}

}  // namespace fasttree
