// SPDX-License-Identifier: Apache-2.0
// A record: one triangle inside one bucket, as it travels through memory until a lane expands it
// into references. Its width follows from the number of triangles and the depth.
#pragma once

#include <array>
#include <cstdint>

#include "grid/grid.h"

namespace fasttree::model::ft2 {

/// A triangle and its box of cells, relative to the corner of its bucket.
struct Record {
  std::uint32_t id = 0;
  CellBox box;
};

/// Where the bits of a record lie: the id, then the lower corner, then the upper, in whole bytes.
class RecordFormat {
 public:
  RecordFormat() = default;
  /// For `triangles` ids, and boxes with these bits an axis.
  RecordFormat(std::uint32_t triangles, const std::array<std::uint8_t, 3>& axis_bits);

  std::uint32_t bytes() const { return bytes_; }
  void pack(const Record& record, std::uint8_t* to) const;
  Record unpack(const std::uint8_t* from) const;

 private:
  std::uint32_t id_bits_ = 1;
  std::array<std::uint8_t, 3> axis_bits_{};
  std::uint32_t bytes_ = 1;
};

/// How a bucket's records lie in its linked chunks: lines of `line_bytes`, the first of a chunk
/// with four bytes that name the next chunk, no record across two lines.
struct ChunkFormat {
  std::uint32_t chunk_bytes = 0;
  std::uint32_t line_bytes = 0;
  std::uint32_t record_bytes = 0;

  static constexpr std::uint32_t kLinkBytes = 4;

  std::uint32_t lines() const { return chunk_bytes / line_bytes; }
  std::uint32_t offset(std::uint32_t line) const { return line == 0 ? kLinkBytes : 0; }
  std::uint32_t records(std::uint32_t line) const {
    return (line_bytes - offset(line)) / record_bytes;
  }
  std::uint32_t records_of_chunk() const { return records(0) + (lines() - 1) * records(1); }
};

}  // namespace fasttree::model::ft2
