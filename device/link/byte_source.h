// SPDX-License-Identifier: Apache-2.0
// Bytes that a stream is made of. They are asked for a frame at a time, and again where a frame got
// lost, so nothing need be copied beforehand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "fasttree/mesh.h"

namespace fasttree::device {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// Bytes [offset, offset + out.size()), which are all there; the same ones every time. Streams
  /// ask at multiples of a triangle's bytes.
  virtual void read(std::uint64_t offset, std::span<std::byte> out) const = 0;
};

/// A mesh as 36 bytes a triangle: nine binary32, three corners. Views the mesh.
class SceneSource : public ByteSource {
 public:
  explicit SceneSource(const MeshView& mesh) : mesh_(mesh) {}
  std::uint64_t size() const override;
  void read(std::uint64_t offset, std::span<std::byte> out) const override;

 private:
  MeshView mesh_;
};

/// Some pieces of memory, one behind the other. Views them.
class PartsSource : public ByteSource {
 public:
  explicit PartsSource(std::vector<std::span<const std::byte>> parts) : parts_(std::move(parts)) {}
  std::uint64_t size() const override;
  void read(std::uint64_t offset, std::span<std::byte> out) const override;

 private:
  std::vector<std::span<const std::byte>> parts_;
};

}  // namespace fasttree::device
