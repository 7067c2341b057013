// SPDX-License-Identifier: Apache-2.0
#include "render/image.h"

#include <cstddef>
#include <cstdlib>
#include <new>
#include <span>
#include <stdexcept>

#include "tree/atomic_file.h"

namespace fasttree::render {

namespace {

// stb_image_write goes on with the old pointer where memory runs out. Here running out throws
// instead, and what stb held is freed on the way: its blocks are links of a ring.
class StbMemory {
 public:
  StbMemory() : outer_(current) { current = this; }
  ~StbMemory() {
    while (ring_.next != &ring_) release(ring_.next + 1);
    current = outer_;
  }
  StbMemory(const StbMemory&) = delete;
  StbMemory& operator=(const StbMemory&) = delete;

  static void* resize(void* old, std::size_t size) {
    Link* const before = old != nullptr ? static_cast<Link*>(old) - 1 : nullptr;
    auto* const link = static_cast<Link*>(std::realloc(before, sizeof(Link) + size));
    if (link == nullptr) throw std::bad_alloc();
    if (before == nullptr) {
      link->previous = &current->ring_;
      link->next = current->ring_.next;
    }
    link->previous->next = link;
    link->next->previous = link;
    return link + 1;
  }
  static void release(void* p) {
    if (p == nullptr) return;
    Link* const link = static_cast<Link*>(p) - 1;
    link->previous->next = link->next;
    link->next->previous = link->previous;
    std::free(link);
  }

 private:
  struct alignas(std::max_align_t) Link {
    Link* previous;
    Link* next;
  };

  static thread_local StbMemory* current;
  StbMemory* outer_;
  Link ring_{&ring_, &ring_};
};

[[noreturn]] void stb_gave_up() {
  throw std::runtime_error("internal error of the PNG encoder");
}

thread_local StbMemory* StbMemory::current = nullptr;

}  // namespace
}  // namespace fasttree::render

#define STBIW_MALLOC(size) fasttree::render::StbMemory::resize(nullptr, size)
#define STBIW_REALLOC(p, size) fasttree::render::StbMemory::resize(p, size)
#define STBIW_FREE(p) fasttree::render::StbMemory::release(p)
#define STBIW_ASSERT(x) ((x) ? (void)0 : fasttree::render::stb_gave_up())
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace fasttree::render {

namespace {

// stb counts bytes in int: raw picture and deflated worst case have to stay below 2^30.
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28;

}  // namespace

Result<std::vector<std::byte>> encode_png(const Image& image) {
  const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
  if (pixels == 0 || pixels > kMaxPixels || image.rgb.size() != 3 * pixels) {
    return Status(StatusCode::invalid_argument,
                  "an image of " + std::to_string(image.width) + " x " +
                      std::to_string(image.height) + " pixels with " +
                      std::to_string(image.rgb.size()) +
                      " bytes; it needs 3 bytes a pixel and 1 to 2^28 pixels");
  }
  try {
    const StbMemory memory;
    int size = 0;
    const unsigned char* bytes = stbi_write_png_to_mem(
        image.rgb.data(), static_cast<int>(3 * image.width), static_cast<int>(image.width),
        static_cast<int>(image.height), 3, &size);
    if (bytes == nullptr || size <= 0)
      return Status(StatusCode::resource_limit, "the picture cannot be encoded");
    const auto* first = reinterpret_cast<const std::byte*>(bytes);
    return std::vector<std::byte>(first, first + size);
  } catch (const std::runtime_error& error) {
    return Status(StatusCode::io_error, error.what());
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::resource_limit,
                  "out of memory while encoding; ask for a smaller picture");
  }
}

Status write_png(const Image& image, const std::string& path) {
  const Result<std::vector<std::byte>> bytes = encode_png(image);
  if (!bytes.ok()) {
    return Status(bytes.status().code(), "cannot write " + path + ": " + bytes.status().message());
  }
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return file.status();
  if (Status status = file.value().write(bytes.value()); !status.ok()) return status;
  return file.value().commit();
}

}  // namespace fasttree::render
