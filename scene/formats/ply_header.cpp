// SPDX-License-Identifier: Apache-2.0
#include "scene/formats/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

namespace fasttree::scene {
namespace {

// Far more than any file has; keeps the search for a second element of one name short.
constexpr std::size_t kMostElements = 1000;

struct TypeName {
  std::string_view name;
  PlyScalar type;
};

// Both sets of names are in use.
constexpr std::array<TypeName, 16> kTypeNames = {{
    {"char", PlyScalar::int8},
    {"int8", PlyScalar::int8},
    {"uchar", PlyScalar::uint8},
    {"uint8", PlyScalar::uint8},
    {"short", PlyScalar::int16},
    {"int16", PlyScalar::int16},
    {"ushort", PlyScalar::uint16},
    {"uint16", PlyScalar::uint16},
    {"int", PlyScalar::int32},
    {"int32", PlyScalar::int32},
    {"uint", PlyScalar::uint32},
    {"uint32", PlyScalar::uint32},
    {"float", PlyScalar::float32},
    {"float32", PlyScalar::float32},
    {"double", PlyScalar::float64},
    {"float64", PlyScalar::float64},
}};

std::optional<PlyScalar> scalar_named(std::string_view name) {
  for (const TypeName& entry : kTypeNames) {
    if (entry.name == name) return entry.type;
  }
  return std::nullopt;
}

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kBlank = " \t";
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(kBlank); at != std::string_view::npos;
       at = line.find_first_not_of(kBlank, at)) {
    const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

class HeaderParser {
 public:
  explicit HeaderParser(const Source& source) : source_(source), text_(source.text()) {}

  Result<PlyHeader> parse() {
    std::string_view line;
    if (!next_line(line) || words_of(line) != std::vector<std::string_view>{"ply"}) {
      return bad_line(source_, 1, "a PLY file begins with a line 'ply'. Is this another format?");
    }
    while (next_line(line)) {
      const std::vector<std::string_view> words = words_of(line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") return finish();
      Status status;
      if (words[0] == "format") {
        status = format(words);
      } else if (words[0] == "element") {
        status = element(words);
      } else if (words[0] == "property") {
        status = property(words);
      } else {
        status = bad("the header has " + excerpt(words[0]) +
                     "; expected format, element, property, comment or end_header.");
      }
      if (!status.ok()) return status;
    }
    return bad_byte(source_, text_.size(),
                    "the file ends before the header's 'end_header'. Is it truncated?");
  }

 private:
  Status bad(const std::string& what) const { return bad_line(source_, line_, what); }

  // The first line decides how lines end: LF, CR LF, or CR alone. It matters in a binary file,
  // whose first byte of data may be either character.
  bool next_line(std::string_view& line) {
    if (at_ >= text_.size()) return false;
    if (line_ == 0) {
      const std::size_t end = text_.find_first_of("\r\n");
      const bool lone_cr = end != std::string_view::npos && text_[end] == '\r' &&
                           (end + 1 == text_.size() || text_[end + 1] != '\n');
      newline_ = lone_cr ? '\r' : '\n';
    }
    const std::size_t end = text_.find(newline_, at_);
    if (end == std::string_view::npos) return false;  // end_header needs its line end, too
    line = text_.substr(at_, end - at_);
    if (newline_ == '\n' && line.ends_with('\r')) line.remove_suffix(1);
    at_ = end + 1;
    ++line_;
    return true;
  }

  Status format(const std::vector<std::string_view>& words) {
    if (has_format_) return bad("a second 'format' line. Remove one.");
    if (words.size() != 3 || words[2] != "1.0") {
      return bad("expected 'format ENCODING 1.0'; other versions are not known.");
    }
    if (words[1] == "ascii") {
      header_.encoding = PlyEncoding::ascii;
    } else if (words[1] == "binary_little_endian") {
      header_.encoding = PlyEncoding::binary_little_endian;
    } else if (words[1] == "binary_big_endian") {
      header_.encoding = PlyEncoding::binary_big_endian;
    } else {
      return bad("encoding " + excerpt(words[1]) +
                 "; expected ascii, binary_little_endian or binary_big_endian.");
    }
    has_format_ = true;
    return {};
  }

  Status element(const std::vector<std::string_view>& words) {
    if (words.size() != 3) return bad("expected 'element NAME COUNT'.");
    if (header_.elements.size() == kMostElements) {
      return bad("more than " + std::to_string(kMostElements) + " elements. Is the file damaged?");
    }
    PlyElement element;
    element.name = words[1];
    const char* const end = words[2].data() + words[2].size();
    const auto [rest, error] = std::from_chars(words[2].data(), end, element.count);
    if (error != std::errc() || rest != end) {
      return bad("element count " + excerpt(words[2]) + " is not a number from 0 up.");
    }
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) {
        return bad("a second element " + excerpt(element.name) + ". Join the two.");
      }
    }
    header_.elements.push_back(std::move(element));
    return {};
  }

  Status property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) return bad("a property before the first element.");
    PlyProperty property;
    property.is_list = words.size() >= 2 && words[1] == "list";
    if (words.size() != (property.is_list ? 5u : 3u)) {
      return bad("expected 'property TYPE NAME' or 'property list COUNT_TYPE TYPE NAME'.");
    }
    const std::string_view type_word = words[words.size() - 2];
    const std::optional<PlyScalar> type = scalar_named(type_word);
    if (!type) {
      return bad("property type " + excerpt(type_word) +
                 "; expected char, uchar, short, ushort, int, uint, float or double.");
    }
    property.type = *type;
    if (property.is_list) {
      const std::optional<PlyScalar> count_type = scalar_named(words[2]);
      if (!count_type || !ply_is_integer(*count_type)) {
        return bad("a list's length of type " + excerpt(words[2]) + "; expected an integer type.");
      }
      property.count_type = *count_type;
    }
    property.name = words.back();
    header_.elements.back().properties.push_back(std::move(property));
    return {};
  }

  Result<PlyHeader> finish() {
    if (!has_format_) return bad("the header has no 'format' line. Add one.");
    header_.body_offset = at_;
    header_.body_line = line_ + 1;
    return std::move(header_);
  }

  const Source& source_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 0;
  char newline_ = '\n';
  bool has_format_ = false;
  PlyHeader header_;
};

}  // namespace

std::size_t ply_size(PlyScalar type) {
  switch (type) {
    case PlyScalar::int8:
    case PlyScalar::uint8:
      return 1;
    case PlyScalar::int16:
    case PlyScalar::uint16:
      return 2;
    case PlyScalar::int32:
    case PlyScalar::uint32:
    case PlyScalar::float32:
      return 4;
    case PlyScalar::float64:
      return 8;
  }
  return 0;
}

bool ply_is_integer(PlyScalar type) {
  return type != PlyScalar::float32 && type != PlyScalar::float64;
}

std::size_t PlyElement::find(const std::string& property) const {
  std::size_t i = 0;
  while (i < properties.size() && properties[i].name != property) ++i;
  return i;
}

std::size_t PlyElement::fixed_row_bytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) {
    if (property.is_list) return 0;
    bytes += ply_size(property.type);
  }
  return bytes;
}

Result<PlyHeader> parse_ply_header(const Source& source) {
  return HeaderParser(source).parse();
}

}  // namespace fasttree::scene
