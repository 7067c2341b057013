// SPDX-License-Identifier: Apache-2.0
// A PLY file's header: which elements follow, how often, and what a row of each holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/formats/source.h"

namespace fasttree::scene {

enum class PlyScalar : std::uint8_t {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  float32,
  float64,
};

std::size_t ply_size(PlyScalar type);
bool ply_is_integer(PlyScalar type);

struct PlyProperty {
  std::string name;
  PlyScalar type = PlyScalar::float32;
  bool is_list = false;
  PlyScalar count_type = PlyScalar::uint8;  ///< of a list's length; an integer type
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// The property's place, or properties.size().
  std::size_t find(const std::string& property) const;
  /// Bytes of a row in a binary file, 0 where it has a list (or no property).
  std::size_t fixed_row_bytes() const;
};

enum class PlyEncoding : std::uint8_t { ascii, binary_little_endian, binary_big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t body_offset = 0;  ///< the first byte after `end_header` and its line end
  std::size_t body_line = 0;    ///< the line that byte lies on
};

/// Reads the header. bad_input with the line.
Result<PlyHeader> parse_ply_header(const Source& source);

}  // namespace fasttree::scene
