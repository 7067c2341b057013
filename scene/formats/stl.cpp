// SPDX-License-Identifier: Apache-2.0
// STL, binary and ascii. Both hold three vertices a triangle; they are kept so, with the indices
// 0, 1, 2, ... beside them.
#include <algorithm>
#include <cctype>
#include <numeric>
#include <string_view>

#include "scene/formats/bytes.h"
#include "scene/formats/formats.h"
#include "scene/formats/mesh_memory.h"
#include "scene/formats/text_scanner.h"

namespace fasttree::scene {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kFirstTriangle = kHeaderBytes + 4;
constexpr std::size_t kTriangleBytes = 50;  // normal, three vertices, 2 bytes of attributes
constexpr std::size_t kNormalBytes = 12;

bool same_word(std::string_view a, std::string_view lower_case) {
  return std::equal(a.begin(), a.end(), lower_case.begin(), lower_case.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == y;
  });
}

Status allocate_soup(const Source& source, const LoadSettings& settings, std::uint64_t triangles,
                     Mesh& mesh) {
  MemoryBudget budget(source, settings);
  if (Status s = budget.allocate(3 * triangles, triangles, mesh); !s.ok()) return s;
  std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
  return {};
}

Result<Mesh> read_binary(const Source& source, const LoadSettings& settings) {
  const std::size_t size = source.bytes.size();
  if (size < kFirstTriangle) {
    return bad_byte(source, size,
                    "a binary STL begins with 84 bytes, an ascii one with 'solid'. The file is "
                    "truncated or of another format.");
  }
  const auto triangles = load<std::uint32_t>(source.bytes.data() + kHeaderBytes);
  const std::size_t room = (size - kFirstTriangle) / kTriangleBytes;
  if (triangles > room) {
    return bad_byte(source, kHeaderBytes,
                    "the file says " + std::to_string(triangles) + " triangles of " +
                        std::to_string(kTriangleBytes) + " bytes, but has room for " +
                        std::to_string(room) + ". It is truncated or of another format.");
  }
  // A few bytes after the last triangle are some exporter's own; a whole triangle is not.
  if (triangles < room) {
    return bad_byte(source, kHeaderBytes,
                    "the file says " + std::to_string(triangles) + " triangles, but holds " +
                        std::to_string(room) + ". It is damaged; export it again.");
  }

  Mesh mesh;
  if (Status s = allocate_soup(source, settings, triangles, mesh); !s.ok()) return s;
  const LoadProgress progress(source, settings, "read STL");
  for (std::uint32_t t = 0; t < triangles; ++t) {
    if (t % LoadProgress::kStep == 0) {
      if (Status s = progress.at(static_cast<double>(t) / triangles); !s.ok()) return s;
    }
    const std::byte* from =
        source.bytes.data() + kFirstTriangle + std::size_t{t} * kTriangleBytes + kNormalBytes;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Vec3& p = mesh.positions[std::size_t{3} * t + corner];
      for (std::size_t axis = 0; axis < 3; ++axis, from += 4) p[axis] = load<float>(from);
    }
  }
  return mesh;
}

/// An ascii STL: solids of facets of three vertices.
class AsciiReader {
 public:
  AsciiReader(const Source& source, const LoadSettings& settings)
      : source_(source), settings_(settings), scanner_(source.text()) {}

  Result<Mesh> read() {
    Mesh mesh;
    if (Status s = allocate_soup(source_, settings_, count_facets(), mesh); !s.ok()) return s;
    const LoadProgress progress(source_, settings_, "read STL");
    bool in_solid = false;
    while (scanner_.next_row()) {
      std::string_view word;
      scanner_.word(word);
      if (same_word(word, "solid") && !in_solid) {
        in_solid = true;  // its name, the rest of the line, can be anything
      } else if (same_word(word, "endsolid") && in_solid) {
        in_solid = false;
      } else if (same_word(word, "facet") && in_solid) {
        // The normal is not used, and is "nan" or missing in many files.
        if (filled_ == mesh.positions.size()) return changed_while_read(source_);
        if (filled_ % LoadProgress::kStep == 0) {
          const double done = static_cast<double>(scanner_.offset());
          if (Status s = progress.at(done / static_cast<double>(scanner_.size())); !s.ok())
            return s;
        }
        if (Status s = facet(&mesh.positions[filled_]); !s.ok()) return s;
        filled_ += 3;
      } else {
        return bad_word(word, in_solid ? "'facet' or 'endsolid'" : "'solid'");
      }
    }
    if (in_solid) return ended("'facet' or 'endsolid'");
    if (filled_ != mesh.positions.size()) return changed_while_read(source_);
    return mesh;
  }

 private:
  // Exactly the rows that `read` takes for facets in a good file; in a bad one `read` fails.
  std::uint64_t count_facets() const {
    TextScanner scanner = scanner_;
    std::uint64_t facets = 0;
    std::string_view word;
    while (scanner.next_row()) {
      scanner.word(word);
      if (same_word(word, "facet")) ++facets;
    }
    return facets;
  }

  Status facet(Vec3* corners) {
    if (Status s = row_of({"outer", "loop"}); !s.ok()) return s;
    for (int corner = 0; corner < 3; ++corner) {
      if (Status s = row_of({"vertex"}); !s.ok()) return s;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::string_view word;
        if (!scanner_.word(word)) {
          return bad_line(source_, scanner_.line(), "a vertex needs three numbers.");
        }
        if (!parse_float(word, corners[corner][axis])) return bad_word(word, "a number");
      }
      if (Status s = row_ends(); !s.ok()) return s;
    }
    if (Status s = row_of({"endloop"}); !s.ok()) return s;
    return row_of({"endfacet"});
  }

  // The next row, which has to begin with these words.
  Status row_of(std::initializer_list<std::string_view> words) {
    if (!scanner_.next_row()) return ended(excerpt(*words.begin()));
    for (const std::string_view expected : words) {
      std::string_view word;
      if (!scanner_.word(word) || !same_word(word, expected)) {
        return bad_word(word, excerpt(expected));
      }
    }
    return {};
  }

  Status row_ends() {
    std::string_view word;
    return scanner_.word(word) ? bad_word(word, "the end of the line") : Status();
  }

  Status bad_word(std::string_view word, const std::string& expected) const {
    return bad_line(source_, scanner_.line(),
                    "found " + excerpt(word) + " instead of " + expected +
                        ". Is the file damaged, or of another format?");
  }
  Status ended(const std::string& expected) const {
    return bad_line(source_, scanner_.line(),
                    "the file ends where " + expected + " has to follow. It is truncated.");
  }

  const Source& source_;
  const LoadSettings& settings_;
  TextScanner scanner_;
  std::size_t filled_ = 0;
};

}  // namespace

bool has_binary_stl_size(const Source& source) {
  const std::size_t size = source.bytes.size();
  return size >= kFirstTriangle &&
         size == kFirstTriangle + std::uint64_t{kTriangleBytes} *
                                      load<std::uint32_t>(source.bytes.data() + kHeaderBytes);
}

Result<Mesh> parse_stl(const Source& source, const LoadSettings& settings) {
  return guarded(source, [&]() -> Result<Mesh> {
    // The size decides first: the header of a binary file may begin with "solid", too.
    if (!has_binary_stl_size(source)) {
      TextScanner scanner(source.text());
      std::string_view word;
      if (scanner.next_row() && scanner.word(word) && same_word(word, "solid")) {
        return AsciiReader(source, settings).read();
      }
    }
    return read_binary(source, settings);
  });
}

}  // namespace fasttree::scene
