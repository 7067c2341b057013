// SPDX-License-Identifier: Apache-2.0
// glTF and GLB: the container, the walk over the nodes, and the triangles of each primitive. In two
// passes: the first plans (which nodes, how many vertices and triangles), the second writes.
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "scene/formats/bytes.h"
#include "scene/formats/formats.h"
#include "scene/formats/gltf_accessor.h"
#include "scene/formats/gltf_buffers.h"
#include "scene/formats/gltf_document.h"
#include "scene/formats/mesh_memory.h"

namespace fasttree::scene {
namespace {

constexpr std::uint32_t kGlbMagic = 0x46546c67;     // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;    // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004e4942;  // "BIN"

struct Container {
  std::string_view json;
  std::size_t json_offset = 0;
  std::optional<std::span<const std::byte>> binary;
};

bool is_glb(const Source& source) {
  return source.bytes.size() >= 4 && load<std::uint32_t>(source.bytes.data()) == kGlbMagic;
}

/// Takes a GLB apart (glTF 2.0, section 4): a header, the JSON chunk, perhaps the binary chunk.
Result<Container> open_glb(const Source& source) {
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunkHeader = 8;
  const std::span<const std::byte> bytes = source.bytes;
  if (bytes.size() < kHeader + kChunkHeader) {
    return bad_byte(source, bytes.size(), "the file ends inside the GLB header. It is truncated.");
  }
  const auto version = load<std::uint32_t>(bytes.data() + 4);
  if (version != 2) {
    return bad_byte(source, 4,
                    "GLB version " + std::to_string(version) +
                        "; only version 2 can be read. Convert the file.");
  }
  const auto length = load<std::uint32_t>(bytes.data() + 8);
  if (length > bytes.size() || length < kHeader + kChunkHeader) {
    return bad_byte(source, 8,
                    "the header says " + std::to_string(length) + " bytes, but the file has " +
                        std::to_string(bytes.size()) + ". It is truncated or damaged.");
  }

  Container out;
  for (std::size_t at = kHeader; length - at >= kChunkHeader;) {
    const auto chunk_length = load<std::uint32_t>(bytes.data() + at);
    const auto chunk_type = load<std::uint32_t>(bytes.data() + at + 4);
    const std::size_t content = at + kChunkHeader;
    if (chunk_length > length - content) {
      return bad_byte(source, at,
                      "a chunk of " + std::to_string(chunk_length) +
                          " bytes goes past the file's end. It is truncated or damaged.");
    }
    if (at == kHeader) {
      if (chunk_type != kJsonChunk) {
        return bad_byte(source, at + 4, "the first chunk of a GLB has to be JSON.");
      }
      out.json = source.text().substr(content, chunk_length);
      out.json_offset = content;
    } else if (chunk_type == kBinaryChunk && !out.binary) {
      out.binary = bytes.subspan(content, chunk_length);
    }
    at = content + chunk_length;
  }
  return out;
}

/// A primitive that makes triangles, checked and ready to be read.
struct Drawing {
  GltfMode mode = GltfMode::triangles;
  std::size_t position_accessor = 0;
  GltfElements positions;
  std::optional<GltfElements> indices;
  std::string path;
  GltfIndex index_accessor;

  std::uint64_t corners() const { return indices ? indices->count() : positions.count(); }
  std::uint64_t triangles() const {
    if (mode == GltfMode::triangles) return corners() / 3;
    return corners() < 3 ? 0 : corners() - 2;
  }
};

/// A mesh of the file: its drawings, and what one instance of it takes.
struct MeshPlan {
  std::vector<Drawing> drawings;
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  /// Where the vertices of a position accessor begin in an instance: drawings often share one.
  std::map<std::size_t, std::uint64_t> first_vertex;
};

struct Instance {
  std::size_t mesh = 0;
  GltfMatrix world = gltf_identity();
};

class GltfReader {
 public:
  GltfReader(const Source& source, const LoadSettings& settings, const GltfDocument& document,
             const Container& container)
      : source_(source),
        settings_(settings),
        document_(document),
        budget_(source, settings),
        buffers_(source, document, container.binary, budget_),
        plans_(document.meshes.size()) {}

  Result<Mesh> read() {
    if (Status s = plan(); !s.ok()) return s;
    Mesh mesh;
    if (Status s = budget_.allocate(vertices_, triangles_, mesh); !s.ok()) return s;
    TriangleWriter writer(mesh);
    const LoadProgress progress(source_, settings_, "read glTF");
    std::uint64_t first_vertex = 0;
    for (const Instance& instance : instances_) {
      const double done = static_cast<double>(first_vertex) / static_cast<double>(vertices_ + 1);
      if (Status s = progress.at(done); !s.ok()) return s;
      const MeshPlan& plan = *plans_[instance.mesh];
      write_positions(plan, instance.world, mesh.positions.data() + first_vertex);
      for (const Drawing& drawing : plan.drawings) {
        const std::uint64_t base = first_vertex + plan.first_vertex.at(drawing.position_accessor);
        if (Status s = write_triangles(drawing, static_cast<std::uint32_t>(base), writer);
            !s.ok()) {
          return s;
        }
      }
      first_vertex += plan.vertices;
    }
    if (!writer.full() || !buffers_.still_whole()) return changed_while_read(source_);
    return mesh;
  }

 private:
  // Walks the nodes depth first, children in order. Each node may be reached once: so a cycle ends,
  // and the walk is no longer than the file.
  Status plan() {
    if (document_.nodes.empty()) {  // meshes without a scene: each once
      for (std::size_t m = 0; m < document_.meshes.size(); ++m) {
        if (Status s = place(m, gltf_identity()); !s.ok()) return s;
      }
      return {};
    }
    struct Visit {
      std::size_t node;
      GltfMatrix parent;
    };
    std::vector<bool> reached(document_.nodes.size(), false);
    std::vector<Visit> stack;
    const auto push = [&](const std::vector<std::size_t>& nodes, const GltfMatrix& parent) {
      for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
        if (reached[*node]) return *node;
        reached[*node] = true;
        stack.push_back({*node, parent});
      }
      return document_.nodes.size();
    };
    std::size_t twice = push(document_.roots, gltf_identity());
    while (twice == document_.nodes.size() && !stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const GltfNode& node = document_.nodes[visit.node];
      const GltfMatrix world = gltf_product(visit.parent, node.local);
      if (node.mesh) {
        if (Status s = place(*node.mesh, world); !s.ok()) return s;
      }
      twice = push(node.children, world);
    }
    if (twice == document_.nodes.size()) return {};
    return bad_input(source_,
                     "nodes[" + std::to_string(twice) +
                         "] is reached twice: nodes have to form trees, without cycles and "
                         "without two parents. Export the file again.");
  }

  Status place(std::size_t mesh, const GltfMatrix& world) {
    if (!plans_[mesh]) {
      if (Status s = plan_mesh(mesh); !s.ok()) return s;
    }
    const MeshPlan& plan = *plans_[mesh];
    if (plan.triangles == 0) return {};
    vertices_ += plan.vertices;
    triangles_ += plan.triangles;
    instances_.push_back({mesh, world});
    // At once, so that many instances of a large mesh cannot overflow the sums.
    return check_counts(source_, vertices_, triangles_);
  }

  Status plan_mesh(std::size_t mesh) {
    MeshPlan plan;
    const std::vector<GltfPrimitive>& primitives = document_.meshes[mesh].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const GltfPrimitive& primitive = primitives[p];
      // Points and lines make no triangle; without positions nothing is to be drawn.
      if (primitive.mode < GltfMode::triangles || !primitive.positions) continue;
      const std::string path =
          "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(p) + "]";
      const Result<GltfElements> positions =
          GltfElements::positions(source_, document_, buffers_, *primitive.positions);
      if (!positions.ok()) return positions.status();
      Drawing drawing{primitive.mode, *primitive.positions, positions.value(), std::nullopt,
                      path,           primitive.indices};
      if (primitive.indices) {
        const Result<GltfElements> indices =
            GltfElements::indices(source_, document_, buffers_, *primitive.indices);
        if (!indices.ok()) return indices.status();
        drawing.indices = indices.value();
      }
      if (drawing.mode == GltfMode::triangles && drawing.corners() % 3 != 0) {
        return bad_input(source_,
                         path + " has " + std::to_string(drawing.corners()) +
                             " corners, which are no whole triangles. The file is damaged.");
      }
      if (drawing.triangles() == 0) continue;
      if (plan.first_vertex.try_emplace(drawing.position_accessor, plan.vertices).second) {
        plan.vertices += drawing.positions.count();
      }
      plan.triangles += drawing.triangles();
      if (Status s = check_counts(source_, plan.vertices, plan.triangles); !s.ok()) return s;
      plan.drawings.push_back(std::move(drawing));
    }
    plans_[mesh] = std::move(plan);
    return {};
  }

  static void write_positions(const MeshPlan& plan, const GltfMatrix& m, Vec3* out) {
    // Without a transform the file's numbers stay as they are, bit for bit.
    const bool unmoved = m == gltf_identity();
    std::uint64_t written = 0;
    for (const Drawing& drawing : plan.drawings) {
      if (plan.first_vertex.at(drawing.position_accessor) != written) continue;  // shared, is there
      for (std::uint64_t i = 0; i < drawing.positions.count(); ++i) {
        const Vec3 p = drawing.positions.position(i);
        Vec3& to = out[written + i];
        if (unmoved) {
          to = p;
          continue;
        }
        for (std::size_t row = 0; row < 3; ++row) {
          to[row] =
              static_cast<float>(m[row] * p.x + m[4 + row] * p.y + m[8 + row] * p.z + m[12 + row]);
        }
      }
      written += drawing.positions.count();
    }
  }

  Status write_triangles(const Drawing& drawing, std::uint32_t base, TriangleWriter& writer) const {
    const std::uint64_t triangles = drawing.triangles();
    for (std::uint64_t t = 0; t < triangles; ++t) {
      // The orders of section 3.7.2.1.
      std::array<std::uint64_t, 3> corners = {3 * t, 3 * t + 1, 3 * t + 2};
      if (drawing.mode == GltfMode::triangle_strip) {
        corners = {t, t + 1 + t % 2, t + 2 - t % 2};
      } else if (drawing.mode == GltfMode::triangle_fan) {
        corners = {t + 1, t + 2, 0};
      }
      std::array<std::uint32_t, 3> vertices = {};
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint64_t index =
            drawing.indices ? drawing.indices->index(corners[c]) : corners[c];
        if (index >= drawing.positions.count()) return bad_index(drawing, t, corners[c], index);
        vertices[c] = base + static_cast<std::uint32_t>(index);
      }
      if (!writer.add(vertices[0], vertices[1], vertices[2])) return changed_while_read(source_);
    }
    return {};
  }

  Status bad_index(const Drawing& drawing, std::uint64_t triangle, std::uint64_t element,
                   std::uint64_t index) const {
    const std::size_t accessor = drawing.index_accessor.value_or(0);
    return bad_input(source_, drawing.path + ": triangle " + std::to_string(triangle) +
                                  " names vertex " + std::to_string(index) + " (element " +
                                  std::to_string(element) + " of accessors[" +
                                  std::to_string(accessor) + "]), but there are " +
                                  std::to_string(drawing.positions.count()) +
                                  ", counted from 0. Repair or export the mesh again.");
  }

  const Source& source_;
  const LoadSettings& settings_;
  const GltfDocument& document_;
  MemoryBudget budget_;
  GltfBuffers buffers_;
  std::vector<std::optional<MeshPlan>> plans_;
  std::vector<Instance> instances_;
  std::uint64_t vertices_ = 0;
  std::uint64_t triangles_ = 0;
};

Result<Mesh> read_gltf(const Source& source, const LoadSettings& settings) {
  Container container{source.text(), 0, std::nullopt};
  if (is_glb(source)) {
    Result<Container> glb = open_glb(source);
    if (!glb.ok()) return glb.status();
    container = glb.value();
  }
  // The parsed JSON takes some times its text; the text alone over the limit is a clear case.
  if (settings.memory_limit_bytes != 0 && container.json.size() > settings.memory_limit_bytes) {
    return Status(StatusCode::resource_limit,
                  source.name + ": its JSON alone is over the memory limit of " +
                      std::to_string(settings.memory_limit_bytes) + " bytes. Raise the limit.");
  }
  const Result<GltfDocument> document =
      parse_gltf_document(source, container.json, container.json_offset);
  if (!document.ok()) return document.status();
  return GltfReader(source, settings, document.value(), container).read();
}

}  // namespace

Result<Mesh> parse_gltf(const Source& source, const LoadSettings& settings) {
  return guarded(source, [&] { return read_gltf(source, settings); });
}

}  // namespace fasttree::scene
