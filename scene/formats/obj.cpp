// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ in two passes: the first counts vertices and triangles, the second reads them into
// memory of exactly that size. So an index may name a vertex further down, as some files do.
#include <algorithm>
#include <array>
#include <string_view>

#include "scene/formats/formats.h"
#include "scene/formats/mesh_memory.h"
#include "scene/formats/text_scanner.h"

namespace fasttree::scene {
namespace {

enum class Statement { vertex, face, other, unknown };

// What a file may say besides v and f: anything of the format is skipped, so that only a file of
// another kind has nothing known at all.
constexpr std::array<std::string_view, 32> kOtherStatements = {
    "vt",     "vn",     "vp",    "g",     "o",     "s",    "l",        "p",
    "usemtl", "mtllib", "mg",    "lod",   "deg",   "bmat", "step",     "cstype",
    "curv",   "curv2",  "surf",  "parm",  "trim",  "hole", "scrv",     "sp",
    "end",    "con",    "bevel", "ctech", "stech", "call", "c_interp", "d_interp"};

Statement statement(std::string_view word) {
  if (word == "v") return Statement::vertex;
  if (word == "f" || word == "fo") return Statement::face;  // "fo" is version 2.11's
  const bool other =
      std::find(kOtherStatements.begin(), kOtherStatements.end(), word) != kOtherStatements.end();
  return other ? Statement::other : Statement::unknown;
}

class ObjReader {
 public:
  ObjReader(const Source& source, const LoadSettings& settings)
      : source_(source), settings_(settings), scanner_(rows()) {}

  Result<Mesh> read() {
    if (Status s = count(); !s.ok()) return s;
    Mesh mesh;
    MemoryBudget budget(source_, settings_);
    if (Status s = budget.allocate(vertices_, triangles_, mesh); !s.ok()) return s;

    const LoadProgress progress(source_, settings_, "read OBJ");
    TriangleWriter writer(mesh);
    std::uint64_t row = 0;
    while (scanner_.next_row()) {
      if (row++ % LoadProgress::kStep == 0) {
        const double done = static_cast<double>(scanner_.offset());
        if (Status s = progress.at(done / static_cast<double>(scanner_.size())); !s.ok()) return s;
      }
      std::string_view word;
      scanner_.word(word);
      Status status;
      switch (statement(word)) {
        case Statement::vertex:
          if (read_ == mesh.positions.size()) return changed_while_read(source_);
          status = vertex(mesh.positions[read_]);
          ++read_;
          break;
        case Statement::face:
          status = face(writer);
          break;
        default:
          break;
      }
      if (!status.ok()) return status;
    }
    if (!writer.full() || read_ != mesh.positions.size()) return changed_while_read(source_);
    return mesh;
  }

 private:
  TextScanner rows() const {
    TextScanner::Options options;
    options.backslash_joins_lines = true;
    options.comment = '#';
    return TextScanner(source_.text(), options);
  }

  Status count() {
    if (const std::size_t zero = source_.text().find('\0'); zero != std::string_view::npos) {
      return bad_byte(source_, zero, "a zero byte: this is no OBJ text file.");
    }
    TextScanner scanner = scanner_;
    TriangleCounter counter;
    bool any_known = false;
    bool any_row = false;
    while (scanner.next_row()) {
      any_row = true;
      std::string_view word;
      scanner.word(word);
      const Statement kind = statement(word);
      any_known |= kind != Statement::unknown;
      if (kind == Statement::vertex) {
        ++vertices_;
      } else if (kind == Statement::face) {
        std::uint64_t corners = 0;
        while (scanner.word(word)) ++corners;
        if (corners >= 3) counter.add_many(corners - 2);
      }
    }
    if (any_row && !any_known) {
      return bad_input(source_,
                       "no line begins with an OBJ statement such as 'v' or 'f'. Is this another "
                       "format?");
    }
    triangles_ = counter.count();
    return {};
  }

  // v x y z, with an optional weight or colour that is not used.
  Status vertex(Vec3& position) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::string_view word;
      if (!scanner_.word(word)) return bad("a vertex needs three numbers.");
      if (!parse_float(word, position[axis])) {
        return bad("found " + excerpt(word) + " where a coordinate has to be.");
      }
    }
    return {};
  }

  Status face(TriangleWriter& writer) {
    Fan<TriangleWriter> fan(writer);
    std::string_view word;
    while (scanner_.word(word)) {
      std::uint32_t index = 0;
      if (Status s = corner(word, index); !s.ok()) return s;
      if (!fan.corner(index)) return changed_while_read(source_);
    }
    return {};
  }

  // v, v/vt, v//vn or v/vt/vn: only the position counts, but the others have to be numbers.
  Status corner(std::string_view word, std::uint32_t& out) {
    std::string_view rest = word;
    std::int64_t index = 0;
    for (int part = 0;; ++part) {
      const std::size_t slash = rest.find('/');
      const std::string_view number = rest.substr(0, slash);
      std::int64_t value = 0;
      if (part > 2 || (!parse_integer(number, value) && !(part > 0 && number.empty()))) {
        return bad("found " + excerpt(word) +
                   " where a corner has to be: v, v/vt, v//vn or v/vt/vn, in whole numbers.");
      }
      if (part == 0) index = value;
      if (slash == std::string_view::npos) break;
      rest.remove_prefix(slash + 1);
    }

    // 1 is the first vertex of the file, -1 the last before this line.
    const auto vertices = static_cast<std::int64_t>(vertices_);
    const auto so_far = static_cast<std::int64_t>(read_);
    if (index >= 1 && index <= vertices) {
      out = static_cast<std::uint32_t>(index - 1);
      return {};
    }
    if (index < 0 && index >= -so_far) {
      out = static_cast<std::uint32_t>(so_far + index);
      return {};
    }
    return bad("a face names vertex " + std::to_string(index) + ", but there are vertices 1 to " +
               std::to_string(vertices) + " in the file, and -1 to -" + std::to_string(so_far) +
               " up to here. Repair or export the mesh again.");
  }

  Status bad(const std::string& what) const { return bad_line(source_, scanner_.line(), what); }

  const Source& source_;
  const LoadSettings& settings_;
  TextScanner scanner_;
  std::uint64_t vertices_ = 0;  // in the whole file
  std::uint64_t triangles_ = 0;
  std::uint64_t read_ = 0;  // vertices so far
};

}  // namespace

Result<Mesh> parse_obj(const Source& source, const LoadSettings& settings) {
  return guarded(source, [&] { return ObjReader(source, settings).read(); });
}

}  // namespace fasttree::scene
