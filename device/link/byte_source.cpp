// SPDX-License-Identifier: Apache-2.0
#include "device/link/byte_source.h"

#include <algorithm>

#include "device/link/messages.h"
#include "device/link/wire.h"

namespace fasttree::device {

std::uint64_t SceneSource::size() const {
  return std::uint64_t{kTriangleBytes} * mesh_.triangle_count;
}

void SceneSource::read(std::uint64_t offset, std::span<std::byte> out) const {
  if (mesh_.indices == nullptr && mesh_.position_stride_bytes == sizeof(Vec3)) {
    std::memcpy(out.data(), static_cast<const std::byte*>(mesh_.positions) + offset, out.size());
    return;
  }
  auto triangle = static_cast<std::uint32_t>(offset / kTriangleBytes);
  for (std::size_t at = 0; at < out.size(); at += kTriangleBytes, ++triangle) {
    const auto corners = mesh_.triangle(triangle);
    static_assert(sizeof corners == kTriangleBytes);
    std::memcpy(out.data() + at, &corners, kTriangleBytes);
  }
}

std::uint64_t PartsSource::size() const {
  std::uint64_t bytes = 0;
  for (const auto& part : parts_) bytes += part.size();
  return bytes;
}

void PartsSource::read(std::uint64_t offset, std::span<std::byte> out) const {
  for (const auto& part : parts_) {
    if (out.empty()) return;
    if (offset >= part.size()) {
      offset -= part.size();
      continue;
    }
    const std::size_t bytes = std::min(out.size(), part.size() - static_cast<std::size_t>(offset));
    std::memcpy(out.data(), part.data() + offset, bytes);
    out = out.subspan(bytes);
    offset = 0;
  }
}

}  // namespace fasttree::device
