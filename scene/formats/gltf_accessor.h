// SPDX-License-Identifier: Apache-2.0
// Elements of a glTF accessor: opened once with every bound checked, then read without checks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "fasttree/vec.h"
#include "scene/formats/gltf_buffers.h"
#include "scene/formats/gltf_document.h"

namespace fasttree::scene {

/// A checked accessor. Views into the buffers, which have to outlive it.
class GltfElements {
 public:
  /// Three components an element, of any type but uint32. bad_input names the accessor.
  static Result<GltfElements> positions(const Source& source, const GltfDocument& document,
                                        GltfBuffers& buffers, std::size_t accessor);
  /// One unsigned component an element.
  static Result<GltfElements> indices(const Source& source, const GltfDocument& document,
                                      GltfBuffers& buffers, std::size_t accessor);

  std::uint64_t count() const { return count_; }
  Vec3 position(std::uint64_t i) const;
  std::uint32_t index(std::uint64_t i) const;

 private:
  struct Array {
    const std::byte* data = nullptr;
    std::uint64_t stride = 0;
    const std::byte* at(std::uint64_t i) const { return data + i * stride; }
  };

  GltfElements() = default;
  static Result<GltfElements> open(const Source& source, const GltfDocument& document,
                                   GltfBuffers& buffers, std::size_t accessor,
                                   std::size_t components);
  static Result<Array> open_array(const Source& source, const GltfDocument& document,
                                  GltfBuffers& buffers, const std::string& path, std::size_t view,
                                  std::uint64_t offset, std::uint64_t count, std::uint64_t bytes);

  /// Where element i lies; null for an element that is zero because nothing defines it.
  const std::byte* element(std::uint64_t i) const;

  GltfComponent component_ = GltfComponent::float32;
  bool normalized_ = false;
  std::uint64_t count_ = 0;
  Array base_;
  std::uint64_t sparse_count_ = 0;
  GltfComponent sparse_component_ = GltfComponent::uint32;
  Array sparse_indices_;
  Array sparse_values_;
};

}  // namespace fasttree::scene
