// SPDX-License-Identifier: Apache-2.0
// The bytes of a glTF's buffers: the GLB's binary chunk, base64 in the JSON, or a file beside it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/formats/gltf_document.h"
#include "scene/formats/mesh_memory.h"
#include "scene/formats/source.h"
#include "scene/mapped_file.h"

namespace fasttree::scene {

/// Finds and keeps buffers, each when it is first asked for: what no triangle needs is not read.
class GltfBuffers {
 public:
  /// `binary_chunk`: of a GLB, else none. All references have to outlive this.
  GltfBuffers(const Source& source, const GltfDocument& document,
              std::optional<std::span<const std::byte>> binary_chunk, MemoryBudget& budget)
      : source_(source),
        document_(document),
        binary_chunk_(binary_chunk),
        budget_(budget),
        buffers_(document.buffers.size()) {}

  /// The bytes of a buffer view. bad_input: the URI is none that may be read, or the buffer is
  /// shorter than its byteLength; io_error: its file cannot be read; resource_limit.
  Result<std::span<const std::byte>> view(std::size_t index);

  /// Bytes of the file and of the buffers read so far.
  std::uint64_t bytes_read() const { return source_.bytes.size() + bytes_read_; }

  /// Whether the files beside the glTF are still as long as when they were mapped.
  bool still_whole() const;

 private:
  struct Buffer {
    bool ready = false;
    std::span<const std::byte> bytes;
    std::vector<std::byte> decoded;  // of base64
    std::shared_ptr<const MappedFile> file;
  };

  Status read(std::size_t index);
  Status read_base64(const std::string& path, std::string_view uri, Buffer& buffer);
  Status read_file(const std::string& path, const std::string& uri, Buffer& buffer);

  const Source& source_;
  const GltfDocument& document_;
  std::optional<std::span<const std::byte>> binary_chunk_;
  MemoryBudget& budget_;
  std::vector<Buffer> buffers_;
  std::uint64_t bytes_read_ = 0;
};

}  // namespace fasttree::scene
