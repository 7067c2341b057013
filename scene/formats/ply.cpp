// SPDX-License-Identifier: Apache-2.0
// PLY in two passes: the first finds where each element begins and counts the triangles, the second
// writes them into memory of exactly that size.
#include <bit>
#include <limits>
#include <utility>
#include <vector>

#include "scene/formats/formats.h"
#include "scene/formats/mesh_memory.h"
#include "scene/formats/ply_header.h"
#include "scene/formats/ply_rows.h"

namespace fasttree::scene {
namespace {

/// A triangle strip: every corner after the second makes a triangle, every other one turned over.
template <typename Triangles>
class Strip {
 public:
  explicit Strip(Triangles& triangles) : triangles_(triangles) {}

  void restart() { corners_ = 0; }
  bool corner(std::uint32_t index) {
    bool room = true;
    if (corners_ >= 2) {
      room = odd_ ? triangles_.add(last_, before_last_, index)
                  : triangles_.add(before_last_, last_, index);
      odd_ = !odd_;
    } else {
      ++corners_;
      odd_ = false;
    }
    before_last_ = last_;
    last_ = index;
    return room;
  }

 private:
  Triangles& triangles_;
  std::uint32_t before_last_ = 0;
  std::uint32_t last_ = 0;
  int corners_ = 0;  // 2 stands for two or more
  bool odd_ = false;
};

/// What the header says about the geometry.
struct Layout {
  std::size_t vertex_element = 0;
  std::size_t axis[3] = {};     // the properties x, y, z
  bool x_y_z_in_a_row = false;  // as float32, in rows of fixed size
  std::size_t x_offset = 0;
};

Result<Layout> find_layout(const Source& source, const PlyHeader& header) {
  Layout layout;
  bool has_vertices = false;
  bool has_triangles = false;
  for (std::size_t e = 0; e < header.elements.size(); ++e) {
    if (header.elements[e].name == "vertex") {
      layout.vertex_element = e;
      has_vertices = true;
    }
    has_triangles |= header.elements[e].name == "face" || header.elements[e].name == "tristrips";
  }
  if (!has_vertices) return bad_input(source, "the header has no element 'vertex'.");
  if (!has_triangles) {
    return bad_input(source,
                     "the header has no element 'face' or 'tristrips'. A point cloud has no "
                     "triangles to build a tree of; make a surface of it first.");
  }

  const PlyElement& vertex = header.elements[layout.vertex_element];
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string name(1, static_cast<char>('x' + a));
    layout.axis[a] = vertex.find(name);
    if (layout.axis[a] == vertex.properties.size() || vertex.properties[layout.axis[a]].is_list) {
      return bad_input(
          source, "the element 'vertex' has no number '" + name + "'. Positions need x, y and z.");
    }
  }
  layout.x_y_z_in_a_row = vertex.fixed_row_bytes() > 0;
  for (std::size_t a = 0; a < 3; ++a) {
    layout.x_y_z_in_a_row &= layout.axis[a] == layout.axis[0] + a &&
                             vertex.properties[layout.axis[a]].type == PlyScalar::float32;
  }
  for (std::size_t p = 0; p < layout.axis[0]; ++p) {
    layout.x_offset += ply_size(vertex.properties[p].type);
  }
  return layout;
}

template <typename Rows>
class PlyBody {
 public:
  PlyBody(const Source& source, const LoadSettings& settings, const PlyHeader& header,
          const Layout& layout)
      : source_(source),
        settings_(settings),
        header_(header),
        layout_(layout),
        vertex_count_(header.elements[layout.vertex_element].count),
        rows_(source, header),
        progress_(source, settings, "read PLY") {}

  Result<Mesh> read(bool view_in_place) {
    const PlyElement& vertex = header_.elements[layout_.vertex_element];
    if (Status s = scan(); !s.ok()) return s;
    if (Status s = check_counts(source_, vertex.count, triangle_count_); !s.ok()) return s;

    Mesh mesh;
    MemoryBudget budget(source_, settings_);
    if (Status s = budget.allocate(view_in_place ? 0 : vertex.count, triangle_count_, mesh);
        !s.ok()) {
      return s;
    }
    TriangleWriter writer(mesh);
    for (std::size_t e = 0; e < header_.elements.size(); ++e) {
      rows_.go_to(marks_[e]);
      Status status;
      if (e == layout_.vertex_element) {
        if (view_in_place) {
          view_positions(mesh, vertex);
        } else {
          status = read_positions(mesh, vertex);
        }
      } else {
        status = read_triangles(header_.elements[e], writer);
      }
      if (!status.ok()) return status;
    }
    if (!writer.full()) return changed_while_read(source_);
    return mesh;
  }

 private:
  // First pass. Walks over every element, needed or not, so that a truncated file is always found.
  Status scan() {
    TriangleCounter counter;
    for (const PlyElement& element : header_.elements) {
      if (marks_.size() == layout_.vertex_element) vertex_offset_ = rows_.offset();
      marks_.push_back(rows_.mark());
      const bool has_list = element.fixed_row_bytes() == 0 && !element.properties.empty();
      Status status;
      if (is_triangles(element)) {
        status = read_triangles(element, counter);
      } else if (has_list) {
        status = skip_rows(element);
      } else if (!rows_.skip_fixed_rows(element)) {
        status = rows_.fail("the element " + excerpt(element.name) + " " + rows_.problem);
      }
      if (!status.ok()) return status;
    }
    if (!rows_.at_end()) {
      return rows_.fail(
          "more data follows than the header says. The counts in the header are wrong, or the "
          "file is damaged.");
    }
    triangle_count_ = counter.count();
    return {};
  }

  static bool is_triangles(const PlyElement& element) {
    return element.name == "face" || element.name == "tristrips";
  }

  Status skip_rows(const PlyElement& element) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
      bool good = rows_.begin_row();
      for (const PlyProperty& property : element.properties) {
        good = good && skip_property(property);
      }
      if (!good || !rows_.end_row()) return row_error(element, row);
    }
    return {};
  }

  bool skip_property(const PlyProperty& property) {
    std::uint64_t values = 1;
    return (!property.is_list || list_length(property, values)) &&
           rows_.skip(property.type, values);
  }

  bool list_length(const PlyProperty& property, std::uint64_t& values) {
    std::int64_t length = 0;
    if (!rows_.integer(property.count_type, length)) return false;
    if (length < 0) {
      rows_.problem = "has a list of " + std::to_string(length) + " values.";
      return false;
    }
    values = static_cast<std::uint64_t>(length);
    return true;
  }

  void view_positions(Mesh& mesh, const PlyElement& vertex) const {
    mesh.mapping = source_.mapping;
    mesh.mapped_stride_bytes = vertex.fixed_row_bytes();
    mesh.mapped_vertex_count = static_cast<std::uint32_t>(vertex.count);
    mesh.mapped_positions = source_.bytes.data() + vertex_offset_ + layout_.x_offset;
  }

  Status read_positions(Mesh& mesh, const PlyElement& vertex) {
    for (std::uint64_t row = 0; row < vertex.count; ++row) {
      if (row % LoadProgress::kStep == 0) {
        if (Status s = progress_.at(0.5 + 0.5 * rows_.fraction()); !s.ok()) return s;
      }
      bool good = rows_.begin_row();
      Vec3& position = mesh.positions[row];
      for (std::size_t p = 0; good && p < vertex.properties.size(); ++p) {
        const PlyProperty& property = vertex.properties[p];
        std::size_t a = 0;
        while (a < 3 && layout_.axis[a] != p) ++a;
        good = a < 3 ? rows_.real(property.type, position[a]) : skip_property(property);
      }
      if (!good || !rows_.end_row()) return row_error(vertex, row);
    }
    return {};
  }

  // Both passes: counts with a TriangleCounter, writes with a TriangleWriter.
  template <typename Triangles>
  Status read_triangles(const PlyElement& element, Triangles& triangles) {
    if (!is_triangles(element)) return {};
    std::size_t list = element.find("vertex_indices");
    if (list == element.properties.size()) list = element.find("vertex_index");
    if (list == element.properties.size() || !element.properties[list].is_list ||
        !ply_is_integer(element.properties[list].type)) {
      if (element.count == 0) return {};
      return bad_input(source_, "the element " + excerpt(element.name) +
                                    " has no list of integers 'vertex_indices'.");
    }

    const bool polygons = element.name == "face";
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (row % LoadProgress::kStep == 0) {
        const double done = 0.5 * rows_.fraction();
        if (Status s = progress_.at(Triangles::kWrites ? 0.5 + done : done); !s.ok()) return s;
      }
      bool good = rows_.begin_row();
      for (std::size_t p = 0; good && p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p != list) {
          good = skip_property(property);
        } else {
          good = polygons ? read_polygon(property, triangles) : read_strips(property, triangles);
        }
      }
      if (!good || !rows_.end_row()) return row_error(element, row);
    }
    return {};
  }

  template <typename Triangles>
  bool read_polygon(const PlyProperty& property, Triangles& triangles) {
    std::uint64_t corners = 0;
    if (!list_length(property, corners)) return false;
    if constexpr (!Triangles::kWrites) {
      if (corners >= 3) triangles.add_many(corners - 2);
      return rows_.skip(property.type, corners);
    } else {
      Fan<Triangles> fan(triangles);
      return rows_.integers(property.type, corners, [&](std::int64_t index) {
        if (!in_range(index)) return false;
        return fan.corner(static_cast<std::uint32_t>(index)) || mesh_full();
      });
    }
  }

  template <typename Triangles>
  bool read_strips(const PlyProperty& property, Triangles& triangles) {
    std::uint64_t corners = 0;
    if (!list_length(property, corners)) return false;
    Strip<Triangles> strip(triangles);
    return rows_.integers(property.type, corners, [&](std::int64_t index) {
      const bool restart = index == -1 || (property.type == PlyScalar::uint32 &&
                                           index == std::numeric_limits<std::uint32_t>::max());
      if (restart) {
        strip.restart();
        return true;
      }
      if (!in_range(index)) return false;
      return strip.corner(static_cast<std::uint32_t>(index)) || mesh_full();
    });
  }

  bool in_range(std::int64_t index) {
    // A negative index is a huge one as an unsigned number.
    return static_cast<std::uint64_t>(index) < vertex_count_ || out_of_range(index);
  }
  bool out_of_range(std::int64_t index) {
    rows_.problem = "names vertex " + std::to_string(index) + ", but the file has " +
                    std::to_string(vertex_count_) +
                    " vertices, counted from 0. Repair or export the mesh again.";
    return false;
  }

  bool mesh_full() {
    full_ = true;
    return false;
  }

  Status row_error(const PlyElement& element, std::uint64_t row) const {
    if (full_) return changed_while_read(source_);
    return rows_.fail("row " + std::to_string(row) + " of element " + excerpt(element.name) + " " +
                      rows_.problem);
  }

  const Source& source_;
  const LoadSettings& settings_;
  const PlyHeader& header_;
  const Layout& layout_;
  std::uint64_t vertex_count_;
  Rows rows_;
  LoadProgress progress_;
  std::vector<typename Rows::Mark> marks_;  // where each element begins
  std::size_t vertex_offset_ = 0;
  std::uint64_t triangle_count_ = 0;
  bool full_ = false;
};

Result<Mesh> read_ply(const Source& source, const LoadSettings& settings) {
  const Result<PlyHeader> header = parse_ply_header(source);
  if (!header.ok()) return header.status();
  const Result<Layout> layout = find_layout(source, header.value());
  if (!layout.ok()) return layout.status();

  switch (header.value().encoding) {
    case PlyEncoding::binary_little_endian: {
      const bool in_place = source.mapping != nullptr && layout.value().x_y_z_in_a_row &&
                            std::endian::native == std::endian::little;
      return PlyBody<PlyBinaryRows<std::endian::little>>(source, settings, header.value(),
                                                         layout.value())
          .read(in_place);
    }
    case PlyEncoding::binary_big_endian:
      return PlyBody<PlyBinaryRows<std::endian::big>>(source, settings, header.value(),
                                                      layout.value())
          .read(false);
    case PlyEncoding::ascii:
      break;
  }
  return PlyBody<PlyAsciiRows>(source, settings, header.value(), layout.value()).read(false);
}

}  // namespace

Result<Mesh> parse_ply(const Source& source, const LoadSettings& settings) {
  return guarded(source, [&] { return read_ply(source, settings); });
}

}  // namespace fasttree::scene
