// SPDX-License-Identifier: Apache-2.0
// A mesh's memory: limits first, then one allocation of the exact size, then bounded writing.
#pragma once

#include <cstdint>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "scene/formats/source.h"

namespace fasttree::scene {

/// Counts the bytes a reader holds against LoadSettings::memory_limit_bytes.
class MemoryBudget {
 public:
  MemoryBudget(const Source& source, const LoadSettings& settings)
      : source_(source), limit_(settings.memory_limit_bytes) {}

  /// Room for working memory. resource_limit: over the limit. To be called before allocating.
  Status claim(std::uint64_t bytes, const char* what);

  /// Sizes `mesh.positions` and `mesh.indices`. resource_limit: over kMaxTriangles, over 32-bit
  /// vertex indices, or over the memory limit. `vertices` is the number to hold in memory (0 where
  /// they are viewed in place).
  Status allocate(std::uint64_t vertices, std::uint64_t triangles, Mesh& mesh);

 private:
  const Source& source_;
  std::uint64_t limit_;
  std::uint64_t held_ = 0;
};

/// Limits of the mesh itself, whatever the memory.
Status check_counts(const Source& source, std::uint64_t vertices, std::uint64_t triangles);

/// Counts triangles and writes nothing: the first pass over a file.
class TriangleCounter {
 public:
  static constexpr bool kWrites = false;
  bool add(std::uint32_t, std::uint32_t, std::uint32_t) {
    ++count_;
    return true;
  }
  void add_many(std::uint64_t triangles) { count_ += triangles; }
  std::uint64_t count() const { return count_; }

 private:
  std::uint64_t count_ = 0;
};

/// Writes triangles into a mesh's indices, never past their end: the second pass. A mapped file
/// can change between the passes, so the first pass's count alone is no bound.
class TriangleWriter {
 public:
  static constexpr bool kWrites = true;
  explicit TriangleWriter(Mesh& mesh)
      : at_(mesh.indices.data()), end_(mesh.indices.data() + mesh.indices.size()) {}

  /// False where the mesh is already full.
  bool add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (at_ == end_) return false;
    at_[0] = a;
    at_[1] = b;
    at_[2] = c;
    at_ += 3;
    return true;
  }
  bool full() const { return at_ == end_; }

 private:
  std::uint32_t* at_;
  std::uint32_t* end_;
};

/// Cuts a polygon into triangles (first, previous, next) as its corners come in; holds no polygon.
template <typename Triangles>
class Fan {
 public:
  explicit Fan(Triangles& triangles) : triangles_(triangles) {}

  void begin() { corners_ = 0; }
  bool corner(std::uint32_t index) {
    bool room = true;
    if (corners_ == 0) {
      first_ = index;
    } else if (corners_ >= 2) {
      room = triangles_.add(first_, previous_, index);
    }
    if (corners_ < 2) ++corners_;
    previous_ = index;
    return room;
  }

 private:
  Triangles& triangles_;
  std::uint32_t first_ = 0;
  std::uint32_t previous_ = 0;
  int corners_ = 0;  // 2 stands for two or more
};

/// The file changed between two passes over it.
Status changed_while_read(const Source& source);

/// Runs a reader; memory that cannot be had, and anything a library below throws, become a status.
template <typename Reader>
Result<Mesh> guarded(const Source& source, Reader&& read) {
  try {
    return std::forward<Reader>(read)();
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::resource_limit,
                  source.name +
                      ": not enough memory for this mesh. Free memory or use a smaller "
                      "mesh.");
  } catch (const std::length_error&) {
    return Status(StatusCode::resource_limit,
                  source.name + ": the mesh is larger than one array can be. Use a smaller mesh.");
  } catch (const std::exception& error) {
    return bad_input(source, std::string("cannot be read: ") + error.what() + ".");
  }
}

}  // namespace fasttree::scene
