// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <string_view>

#include "scene/formats/formats.h"
#include "scene/formats/mesh_memory.h"
#include "scene/formats/source.h"
#include "scene/mapped_file.h"
#include "scene/scene.h"

namespace fasttree::scene {
namespace {

struct Format {
  Result<Mesh> (*parse)(const Source&, const LoadSettings&);
};

constexpr std::string_view kSupported =
    "Mesh files that can be read are PLY, OBJ, STL, glTF and GLB.";

std::string lower_case_extension(const std::string& path) {
  const std::size_t dot = path.find_last_of('.');
  const std::size_t slash = path.find_last_of('/');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return "";
  std::string extension = path.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// The reader for a file. Its first bytes decide where they are certain, then its name, then what
/// the bytes look like.
Result<Format> find_format(const Source& source, const std::string& path) {
  const std::string_view text = source.text();
  if (text.empty()) return bad_input(source, "the file is empty.");
  if (text.starts_with("ply\n") || text.starts_with("ply\r")) return Format{&parse_ply};
  if (text.starts_with("glTF")) return Format{&parse_gltf};
  if (text.starts_with("\x1f\x8b") || text.starts_with("PK\x03\x04")) {
    return bad_input(source, "the file is compressed (gzip or zip). Unpack it first.");
  }
  const std::string extension = lower_case_extension(path);
  if (extension == "ply") return Format{&parse_ply};
  if (extension == "obj") return Format{&parse_obj};
  if (extension == "stl") return Format{&parse_stl};
  if (extension == "gltf" || extension == "glb") return Format{&parse_gltf};

  if (text.starts_with("solid") || has_binary_stl_size(source)) return Format{&parse_stl};
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '{') return Format{&parse_gltf};
  return bad_input(source, "neither its name nor its content is that of a known format. " +
                               std::string(kSupported));
}

}  // namespace

MeshView Mesh::view() const {
  MeshView view;
  if (mapped_positions != nullptr) {
    view.positions = mapped_positions;
    view.position_stride_bytes = mapped_stride_bytes;
    view.vertex_count = mapped_vertex_count;
  } else {
    view.positions = positions.data();
    view.vertex_count = static_cast<std::uint32_t>(positions.size());
  }
  view.indices = indices.data();
  view.triangle_count = static_cast<std::uint32_t>(indices.size() / 3);
  return view;
}

Result<Mesh> load_mesh_file(const std::string& path, const LoadSettings& settings) {
  Result<std::shared_ptr<const MappedFile>> opened = MappedFile::open(path);
  if (!opened.ok()) return opened.status();
  const std::shared_ptr<const MappedFile> file = opened.value();

  Source source;
  source.name = path;
  source.bytes = file->bytes();
  source.mapping = file;
  const std::size_t slash = path.find_last_of('/');
  source.folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);

  const Result<Format> format = find_format(source, path);
  if (!format.ok()) return format.status();
  Result<Mesh> mesh = format.value().parse(source, settings);
  if (!mesh.ok()) return mesh;
  if (!file->still_whole()) return changed_while_read(source);
  mesh.value().name = stem(path);
  return mesh;
}

Result<Mesh> load_scene(const std::string& spec, const LoadSettings& settings) {
  if (spec.starts_with("scene:")) return make_procedural_scene(spec, settings);
  return load_mesh_file(spec, settings);
}

}  // namespace fasttree::scene
