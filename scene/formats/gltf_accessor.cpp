// SPDX-License-Identifier: Apache-2.0
#include "scene/formats/gltf_accessor.h"

#include <algorithm>

#include "scene/formats/bytes.h"

namespace fasttree::scene {
namespace {

bool is_unsigned(GltfComponent component) {
  return component == GltfComponent::uint8 || component == GltfComponent::uint16 ||
         component == GltfComponent::uint32;
}

std::uint32_t load_unsigned(GltfComponent component, const std::byte* from) {
  if (component == GltfComponent::uint8) return load<std::uint8_t>(from);
  if (component == GltfComponent::uint16) return load<std::uint16_t>(from);
  return load<std::uint32_t>(from);
}

// Integers as positions are KHR_mesh_quantization's; section 3.11 has the normalized ones.
float load_coordinate(GltfComponent component, bool normalized, const std::byte* from) {
  float value = 0;
  float most = 1;
  switch (component) {
    case GltfComponent::int8:
      value = load<std::int8_t>(from);
      most = 127;
      break;
    case GltfComponent::uint8:
      value = load<std::uint8_t>(from);
      most = 255;
      break;
    case GltfComponent::int16:
      value = load<std::int16_t>(from);
      most = 32767;
      break;
    case GltfComponent::uint16:
      value = load<std::uint16_t>(from);
      most = 65535;
      break;
    case GltfComponent::uint32:
    case GltfComponent::float32:
      return load<float>(from);
  }
  return normalized ? std::max(value / most, -1.0f) : value;
}

std::string path_of(std::size_t accessor) {
  return "accessors[" + std::to_string(accessor) + "]";
}

}  // namespace

Result<GltfElements::Array> GltfElements::open_array(const Source& source,
                                                     const GltfDocument& document,
                                                     GltfBuffers& buffers, const std::string& path,
                                                     std::size_t view, std::uint64_t offset,
                                                     std::uint64_t count, std::uint64_t bytes) {
  const std::uint64_t given = document.views[view].byte_stride;
  if (given != 0 && given < bytes) {
    return bad_input(source, "bufferViews[" + std::to_string(view) + "].byteStride is " +
                                 std::to_string(given) + ", less than an element of " + path +
                                 ". The file is damaged.");
  }
  Array array;
  array.stride = given != 0 ? given : bytes;
  // No overflow: numbers of the document are at most 2^53, strides at most 252.
  const std::uint64_t end = count == 0 ? 0 : offset + (count - 1) * array.stride + bytes;
  const std::uint64_t length = document.views[view].byte_length;
  if (end > length) {
    return bad_input(source, path + " ends at byte " + std::to_string(end) + " of bufferViews[" +
                                 std::to_string(view) + "], which has " + std::to_string(length) +
                                 ". The file is damaged.");
  }
  if (count == 0) return array;
  const Result<std::span<const std::byte>> view_bytes = buffers.view(view);
  if (!view_bytes.ok()) return view_bytes.status();
  array.data = view_bytes.value().data() + offset;
  return array;
}

Result<GltfElements> GltfElements::open(const Source& source, const GltfDocument& document,
                                        GltfBuffers& buffers, std::size_t accessor,
                                        std::size_t components) {
  const GltfAccessor& described = document.accessors[accessor];
  const std::string path = path_of(accessor);
  const std::uint64_t bytes = components * gltf_size(described.component);
  GltfElements out;
  out.component_ = described.component;
  out.normalized_ = described.normalized;
  out.count_ = described.count;
  if (described.view) {
    const Result<Array> base = open_array(source, document, buffers, path, *described.view,
                                          described.byte_offset, described.count, bytes);
    if (!base.ok()) return base.status();
    out.base_ = base.value();
  }

  if (described.sparse) {
    const GltfSparse& sparse = *described.sparse;
    if (!is_unsigned(sparse.index_component)) {
      return bad_input(source, path + ".sparse.indices.componentType has to be unsigned.");
    }
    if (sparse.count > described.count) {
      return bad_input(source, path + ".sparse.count is over the accessor's own count.");
    }
    const Result<Array> indices =
        open_array(source, document, buffers, path + ".sparse.indices", sparse.index_view,
                   sparse.index_offset, sparse.count, gltf_size(sparse.index_component));
    if (!indices.ok()) return indices.status();
    const Result<Array> values =
        open_array(source, document, buffers, path + ".sparse.values", sparse.value_view,
                   sparse.value_offset, sparse.count, bytes);
    if (!values.ok()) return values.status();
    out.sparse_count_ = sparse.count;
    out.sparse_component_ = sparse.index_component;
    out.sparse_indices_ = indices.value();
    out.sparse_values_ = values.value();
    for (std::uint64_t i = 0, least = 0; i < sparse.count; ++i) {
      const std::uint64_t index = load_unsigned(sparse.index_component, out.sparse_indices_.at(i));
      if (index < least || index >= described.count) {
        return bad_input(source, path + ".sparse.indices: element " + std::to_string(i) + " is " +
                                     std::to_string(index) +
                                     "; they have to rise and stay below the accessor's count of " +
                                     std::to_string(described.count) + ". The file is damaged.");
      }
      least = index + 1;
    }
  }

  // Without a view the count stands for zeros that the file does not hold. More of them than there
  // are bytes is no mesh but an attempt to fill the memory.
  if (!described.view && described.count > buffers.bytes_read()) {
    return bad_input(source, path + " has no bufferView and a count of " +
                                 std::to_string(described.count) +
                                 ", more than the file has bytes. Is its data compressed, or the "
                                 "file damaged?");
  }
  return out;
}

Result<GltfElements> GltfElements::positions(const Source& source, const GltfDocument& document,
                                             GltfBuffers& buffers, std::size_t accessor) {
  const GltfAccessor& described = document.accessors[accessor];
  if (described.type != "VEC3" || described.component == GltfComponent::uint32) {
    return bad_input(source,
                     path_of(accessor) +
                         " holds positions, which have to be VEC3 of floats (5126) or of 8- "
                         "or 16-bit integers.");
  }
  return open(source, document, buffers, accessor, 3);
}

Result<GltfElements> GltfElements::indices(const Source& source, const GltfDocument& document,
                                           GltfBuffers& buffers, std::size_t accessor) {
  const GltfAccessor& described = document.accessors[accessor];
  if (described.type != "SCALAR" || !is_unsigned(described.component) || described.normalized) {
    return bad_input(source, path_of(accessor) +
                                 " holds indices, which have to be SCALAR and unsigned (5121, 5123 "
                                 "or 5125), not normalized.");
  }
  return open(source, document, buffers, accessor, 1);
}

const std::byte* GltfElements::element(std::uint64_t i) const {
  std::uint64_t low = 0;  // binary search for the first sparse index that is not below i
  for (std::uint64_t high = sparse_count_; low < high;) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (load_unsigned(sparse_component_, sparse_indices_.at(middle)) < i) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low < sparse_count_ && load_unsigned(sparse_component_, sparse_indices_.at(low)) == i) {
    return sparse_values_.at(low);
  }
  return base_.data == nullptr ? nullptr : base_.at(i);
}

Vec3 GltfElements::position(std::uint64_t i) const {
  Vec3 out;
  const std::byte* from = element(i);
  if (from == nullptr) return out;
  for (std::size_t axis = 0; axis < 3; ++axis, from += gltf_size(component_)) {
    out[axis] = load_coordinate(component_, normalized_, from);
  }
  return out;
}

std::uint32_t GltfElements::index(std::uint64_t i) const {
  const std::byte* from = element(i);
  return from == nullptr ? 0 : load_unsigned(component_, from);
}

}  // namespace fasttree::scene
