// SPDX-License-Identifier: Apache-2.0
// A picture in memory, and its way into a PNG file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fasttree/status.h"

namespace fasttree::render {

/// 8 bits a channel, red, green, blue; rows from the top, each from the left, nothing between them.
struct Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 * width * height bytes

  friend bool operator==(const Image&, const Image&) = default;
};

/// The picture as the bytes of a PNG file. invalid_argument: an image without pixels or of the
/// wrong size; resource_limit: the memory is full.
Result<std::vector<std::byte>> encode_png(const Image& image);

/// Writes the picture to a temporary name beside `path`, flushes it and renames it into place, so
/// that `path` holds either what it held before or the whole picture. invalid_argument: an image
/// without pixels or of the wrong size; io_error: cannot create or write; resource_limit: the disk
/// or the memory is full.
Status write_png(const Image& image, const std::string& path);

}  // namespace fasttree::render
