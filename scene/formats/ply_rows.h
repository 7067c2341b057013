// SPDX-License-Identifier: Apache-2.0
// The rows of a PLY body, binary or ascii, behind one interface, so that ply.cpp says once what an
// element means. A call that returns false has set `problem`; nothing is read past the file's end.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "scene/formats/bytes.h"
#include "scene/formats/ply_header.h"
#include "scene/formats/text_scanner.h"

namespace fasttree::scene {

/// Rows of a binary body: values without gaps.
template <std::endian Order>
class PlyBinaryRows {
 public:
  using Mark = std::size_t;

  PlyBinaryRows(const Source& source, const PlyHeader& header)
      : source_(source), at_(header.body_offset) {}

  Mark mark() const { return at_; }
  void go_to(Mark mark) { at_ = mark; }
  std::size_t offset() const { return at_; }  ///< in the file
  double fraction() const {
    return static_cast<double>(at_) / static_cast<double>(source_.bytes.size() + 1);
  }

  bool begin_row() { return true; }
  bool end_row() { return true; }

  bool integer(PlyScalar type, std::int64_t& out) {
    return integers(type, 1, [&out](std::int64_t value) {
      out = value;
      return true;
    });
  }

  /// `count` integers, each given to `visit`, until that returns false.
  template <typename Visit>
  bool integers(PlyScalar type, std::uint64_t count, const Visit& visit) {
    switch (type) {
      case PlyScalar::int8:
        return integers_as<std::int8_t>(count, visit);
      case PlyScalar::uint8:
        return integers_as<std::uint8_t>(count, visit);
      case PlyScalar::int16:
        return integers_as<std::int16_t>(count, visit);
      case PlyScalar::uint16:
        return integers_as<std::uint16_t>(count, visit);
      case PlyScalar::int32:
        return integers_as<std::int32_t>(count, visit);
      default:
        return integers_as<std::uint32_t>(count, visit);
    }
  }

  bool real(PlyScalar type, float& out) {
    if (ply_is_integer(type)) {
      std::int64_t value = 0;
      if (!integer(type, value)) return false;
      out = static_cast<float>(value);
      return true;
    }
    if (!has(1, ply_size(type))) return false;
    const std::byte* from = source_.bytes.data() + at_;
    at_ += ply_size(type);
    out = type == PlyScalar::float32 ? load<float, Order>(from)
                                     : static_cast<float>(load<double, Order>(from));
    return true;
  }

  bool skip(PlyScalar type, std::uint64_t values) {
    if (!has(values, ply_size(type))) return false;
    at_ += values * ply_size(type);
    return true;
  }

  /// All rows of an element without lists at once.
  bool skip_fixed_rows(const PlyElement& element) {
    const std::size_t row = element.fixed_row_bytes();
    if (row == 0) return true;
    const std::size_t left = source_.bytes.size() - at_;
    if (element.count > left / row) {
      problem = "needs " + std::to_string(element.count) + " rows of " + std::to_string(row) +
                " bytes, but only " + std::to_string(left) +
                " bytes are left. The file is truncated, or its header is wrong.";
      return false;
    }
    at_ += element.count * row;
    return true;
  }

  /// Whether nothing follows but blanks and zeros.
  bool at_end() {
    for (std::size_t i = at_; i < source_.bytes.size(); ++i) {
      const auto c = std::to_integer<char>(source_.bytes[i]);
      if (c != '\0' && c != ' ' && c != '\t' && c != '\r' && c != '\n') return false;
    }
    return true;
  }

  Status fail(const std::string& what) const { return bad_byte(source_, at_, what); }

  std::string problem;

 private:
  // The only places where `at_` moves on make sure first that it stays in the file.
  template <typename T, typename Visit>
  bool integers_as(std::uint64_t count, const Visit& visit) {
    if (!has(count, sizeof(T))) return false;
    for (; count > 0; --count) {
      const T value = load<T, Order>(source_.bytes.data() + at_);
      at_ += sizeof(T);
      if (!visit(std::int64_t{value})) return false;
    }
    return true;
  }

  bool has(std::uint64_t values, std::size_t size) {
    return values <= (source_.bytes.size() - at_) / size || ended(values * size);
  }
  bool ended(std::uint64_t bytes) {
    problem = "needs " + std::to_string(bytes) + " more bytes, but only " +
              std::to_string(source_.bytes.size() - at_) +
              " are left. The file is truncated, or a count in it is wrong.";
    return false;
  }

  const Source& source_;
  std::size_t at_;
};

/// Rows of an ascii body: a line each; blank lines do not count.
class PlyAsciiRows {
 public:
  using Mark = TextScanner;

  PlyAsciiRows(const Source& source, const PlyHeader& header)
      : source_(source),
        body_offset_(header.body_offset),
        scanner_(source.text().substr(header.body_offset), {}, header.body_line) {}

  Mark mark() const { return scanner_; }
  void go_to(const Mark& mark) { scanner_ = mark; }
  std::size_t offset() const { return body_offset_ + scanner_.offset(); }
  double fraction() const {
    return static_cast<double>(scanner_.offset()) / static_cast<double>(scanner_.size() + 1);
  }

  bool begin_row() {
    if (scanner_.next_row()) return true;
    problem = "is missing: the file ends here. It is truncated, or its header is wrong.";
    return false;
  }
  bool end_row() {
    std::string_view word;
    if (!scanner_.word(word)) return true;
    problem = "has more values than the header says, from " + excerpt(word) + " on.";
    return false;
  }

  bool integer(PlyScalar, std::int64_t& out) {
    std::string_view word;
    if (!next(word)) return false;
    if (parse_integer(word, out)) return true;
    problem = "has " + excerpt(word) + " where a whole number has to be.";
    return false;
  }

  template <typename Visit>
  bool integers(PlyScalar type, std::uint64_t count, const Visit& visit) {
    std::int64_t value = 0;
    for (; count > 0; --count) {
      if (!integer(type, value) || !visit(value)) return false;
    }
    return true;
  }

  bool real(PlyScalar, float& out) {
    std::string_view word;
    if (!next(word)) return false;
    if (parse_float(word, out)) return true;
    problem = "has " + excerpt(word) + " where a number has to be.";
    return false;
  }

  bool skip(PlyScalar, std::uint64_t values) {
    std::string_view word;
    for (; values > 0; --values) {
      if (!next(word)) return false;
    }
    return true;
  }

  bool skip_fixed_rows(const PlyElement& element) {
    if (element.properties.empty()) return true;  // such rows have no line
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (!begin_row()) return false;
    }
    return true;
  }

  bool at_end() { return !scanner_.next_row(); }

  Status fail(const std::string& what) const { return bad_line(source_, scanner_.line(), what); }

  std::string problem;

 private:
  bool next(std::string_view& word) {
    if (scanner_.word(word)) return true;
    problem = "ends too early: the header promises more values on this line.";
    return false;
  }

  const Source& source_;
  std::size_t body_offset_;
  TextScanner scanner_;
};

}  // namespace fasttree::scene
