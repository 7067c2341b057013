// SPDX-License-Identifier: Apache-2.0
#include "scene/formats/gltf_document.h"

#include <algorithm>
#include <utility>

#include "scene/formats/json_object.h"

namespace fasttree::scene {
namespace {

using Json = nlohmann::json;
using Object = JsonObject;

std::string element_path(const char* array, std::size_t i) {
  return std::string(array) + "[" + std::to_string(i) + "]";
}

GltfComponent component(const Object& object) {
  const std::uint64_t number = object.number("componentType");
  switch (number) {
    case 5120:
    case 5121:
    case 5122:
    case 5123:
    case 5125:
    case 5126:
      return static_cast<GltfComponent>(number);
    default:
      fail(object.path("componentType"),
           "is " + std::to_string(number) + "; expected 5120 to 5123, 5125 or 5126.");
  }
}

/// Reads the document's arrays; each after those it refers to.
class Reader {
 public:
  explicit Reader(const Json& json) : root_(json, "") {}

  GltfDocument read() {
    check_asset();
    each("buffers", [this](const Object& o) { document_.buffers.push_back(buffer(o)); });
    each("bufferViews", [this](const Object& o) { document_.views.push_back(view(o)); });
    each("accessors", [this](const Object& o) { document_.accessors.push_back(accessor(o)); });
    each("meshes", [this](const Object& o) { document_.meshes.push_back(mesh(o)); });
    node_count_ = root_.has("nodes") ? root_.array("nodes").size() : 0;
    each("nodes", [this](const Object& o) { document_.nodes.push_back(node(o)); });
    find_roots();
    return std::move(document_);
  }

 private:
  template <typename Read>
  void each(const char* key, Read&& read) const {
    if (!root_.has(key)) return;
    const Json& array = root_.array(key);
    for (std::size_t i = 0; i < array.size(); ++i) read(Object(array[i], element_path(key, i)));
  }

  void check_asset() const {
    const std::string version = root_.object("asset").string("version");
    if (!version.starts_with("2.")) {
      fail("asset.version",
           "is " + excerpt(version) + "; only glTF 2 can be read. Convert the file.");
    }
    if (!root_.has("extensionsRequired")) return;
    for (const Json& extension : root_.array("extensionsRequired")) {
      const std::string name = extension.is_string() ? extension.get<std::string>() : "";
      if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression") {
        fail("extensionsRequired",
             "has " + name + ": compressed geometry cannot be read. Export the file without it.");
      }
      if (name == "EXT_mesh_gpu_instancing") refuse_instancing("extensionsRequired");
    }
  }

  [[noreturn]] static void refuse_instancing(const std::string& path) {
    fail(path,
         "has EXT_mesh_gpu_instancing, which cannot be read. Export the file with plain nodes.");
  }

  GltfBuffer buffer(const Object& o) const {
    GltfBuffer buffer;
    if (o.has("uri")) buffer.uri = o.string("uri");
    buffer.byte_length = o.number("byteLength");
    return buffer;
  }

  GltfBufferView view(const Object& o) const {
    GltfBufferView view;
    view.buffer = o.index("buffer", document_.buffers.size(), "buffers");
    view.byte_offset = o.number("byteOffset", 0);
    view.byte_length = o.number("byteLength");
    view.byte_stride = o.number("byteStride", 0);
    const std::uint64_t buffer_length = document_.buffers[view.buffer].byte_length;
    if (view.byte_offset > buffer_length || view.byte_length > buffer_length - view.byte_offset) {
      fail(o.path(), "ends at byte " + std::to_string(view.byte_offset + view.byte_length) +
                         " of a buffer of " + std::to_string(buffer_length) + ".");
    }
    constexpr std::uint64_t kMostStride = 252;  // by the specification
    if (view.byte_stride > kMostStride) {
      fail(o.path("byteStride"), "is over " + std::to_string(kMostStride) + ".");
    }
    return view;
  }

  GltfAccessor accessor(const Object& o) const {
    GltfAccessor accessor;
    accessor.view = o.optional_index("bufferView", document_.views.size(), "bufferViews");
    accessor.byte_offset = o.number("byteOffset", 0);
    accessor.count = o.number("count");
    accessor.component = component(o);
    accessor.normalized = o.boolean("normalized", false);
    accessor.type = o.string("type");
    if (o.has("sparse")) accessor.sparse = sparse(o.object("sparse"));
    return accessor;
  }

  GltfSparse sparse(const Object& o) const {
    GltfSparse sparse;
    sparse.count = o.number("count");
    const Object indices = o.object("indices");
    sparse.index_view = indices.index("bufferView", document_.views.size(), "bufferViews");
    sparse.index_offset = indices.number("byteOffset", 0);
    sparse.index_component = component(indices);
    const Object values = o.object("values");
    sparse.value_view = values.index("bufferView", document_.views.size(), "bufferViews");
    sparse.value_offset = values.number("byteOffset", 0);
    return sparse;
  }

  GltfMesh mesh(const Object& o) const {
    GltfMesh mesh;
    const Json& primitives = o.array("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      mesh.primitives.push_back(
          primitive(Object(primitives[i], o.path() + "." + element_path("primitives", i))));
    }
    return mesh;
  }

  GltfPrimitive primitive(const Object& o) const {
    GltfPrimitive primitive;
    const std::uint64_t mode = o.number("mode", static_cast<std::uint64_t>(GltfMode::triangles));
    if (mode > static_cast<std::uint64_t>(GltfMode::triangle_fan)) {
      fail(o.path("mode"), "is " + std::to_string(mode) + "; expected 0 to 6.");
    }
    primitive.mode = static_cast<GltfMode>(mode);
    const std::size_t accessors = document_.accessors.size();
    primitive.positions = o.object("attributes").optional_index("POSITION", accessors, "accessors");
    primitive.indices = o.optional_index("indices", accessors, "accessors");

    // A compressed primitive whose accessors hold the plain data as well can be read.
    if (o.has("extensions") && o.object("extensions").has("KHR_draco_mesh_compression")) {
      for (const GltfIndex& used : {primitive.positions, primitive.indices}) {
        if (used && !document_.accessors[*used].view && !document_.accessors[*used].sparse) {
          fail(o.path(),
               "is compressed by KHR_draco_mesh_compression, which cannot be read. "
               "Export the file without it.");
        }
      }
    }
    return primitive;
  }

  template <std::size_t kSize>
  std::array<double, kSize> numbers(const Object& o, const char* key) const {
    const Json& array = o.array(key);
    std::array<double, kSize> out = {};
    bool good = array.size() == kSize;
    for (std::size_t i = 0; good && i < kSize; ++i) {
      good = array[i].is_number();
      if (good) out[i] = array[i].get<double>();
    }
    if (!good) fail(o.path(key), "has to be " + std::to_string(kSize) + " numbers.");
    return out;
  }

  GltfNode node(const Object& o) const {
    GltfNode node;
    node.mesh = o.optional_index("mesh", document_.meshes.size(), "meshes");
    if (o.has("children")) {
      const Json& children = o.array("children");
      for (std::size_t i = 0; i < children.size(); ++i) {
        node.children.push_back(Object::checked_index(
            children[i], o.path() + "." + element_path("children", i), node_count_, "nodes"));
      }
    }
    if (o.has("extensions") && o.object("extensions").has("EXT_mesh_gpu_instancing")) {
      refuse_instancing(o.path());
    }
    node.local = local_transform(o);
    return node;
  }

  GltfMatrix local_transform(const Object& o) const {
    const bool parts = o.has("translation") || o.has("rotation") || o.has("scale");
    if (o.has("matrix")) {
      if (parts) fail(o.path(), "has a matrix and also translation, rotation or scale. Keep one.");
      return numbers<16>(o, "matrix");
    }
    GltfMatrix m = gltf_identity();
    if (!parts) return m;
    if (o.has("rotation")) {
      const auto [x, y, z, w] = numbers<4>(o, "rotation");  // a unit quaternion
      m = {1 - 2 * (y * y + z * z),
           2 * (x * y + z * w),
           2 * (x * z - y * w),
           0,
           2 * (x * y - z * w),
           1 - 2 * (x * x + z * z),
           2 * (y * z + x * w),
           0,
           2 * (x * z + y * w),
           2 * (y * z - x * w),
           1 - 2 * (x * x + y * y),
           0,
           0,
           0,
           0,
           1};
    }
    if (o.has("scale")) {
      const std::array<double, 3> scale = numbers<3>(o, "scale");
      for (std::size_t column = 0; column < 3; ++column) {
        for (std::size_t row = 0; row < 3; ++row) m[4 * column + row] *= scale[column];
      }
    }
    if (o.has("translation")) {
      const std::array<double, 3> translation = numbers<3>(o, "translation");
      std::copy(translation.begin(), translation.end(), m.begin() + 12);
    }
    return m;
  }

  void find_roots() {
    const std::size_t scenes = root_.has("scenes") ? root_.array("scenes").size() : 0;
    GltfIndex scene = root_.optional_index("scene", scenes, "scenes");
    if (!scene && scenes > 0) scene = 0;
    if (scene) {
      const Object o(root_.array("scenes")[*scene], element_path("scenes", *scene));
      if (!o.has("nodes")) return;
      const Json& nodes = o.array("nodes");
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        document_.roots.push_back(Object::checked_index(
            nodes[i], o.path() + "." + element_path("nodes", i), node_count_, "nodes"));
      }
      return;
    }
    // A library of meshes without a scene: every node that is no other's child.
    std::vector<bool> is_child(node_count_, false);
    for (const GltfNode& node : document_.nodes) {
      for (const std::size_t child : node.children) is_child[child] = true;
    }
    for (std::size_t i = 0; i < node_count_; ++i) {
      if (!is_child[i]) document_.roots.push_back(i);
    }
  }

  Object root_;
  GltfDocument document_;
  std::size_t node_count_ = 0;
};

// The parser itself keeps its stack on the heap, but nothing good is nested this deep.
constexpr int kMostNesting = 100;

/// The byte where the brackets nest too deep, or npos.
std::size_t too_deep(std::string_view json) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMostNesting) return i;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return std::string_view::npos;
}

}  // namespace

std::size_t gltf_size(GltfComponent component) {
  switch (component) {
    case GltfComponent::int8:
    case GltfComponent::uint8:
      return 1;
    case GltfComponent::int16:
    case GltfComponent::uint16:
      return 2;
    case GltfComponent::uint32:
    case GltfComponent::float32:
      return 4;
  }
  return 4;
}

GltfMatrix gltf_identity() {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}

GltfMatrix gltf_product(const GltfMatrix& a, const GltfMatrix& b) {
  GltfMatrix out = {};
  for (std::size_t column = 0; column < 4; ++column) {
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t k = 0; k < 4; ++k) {
        out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
      }
    }
  }
  return out;
}

Result<GltfDocument> parse_gltf_document(const Source& source, std::string_view json,
                                         std::size_t offset) {
  if (const std::size_t at = too_deep(json); at != std::string_view::npos) {
    return bad_byte(source, offset + at,
                    "brackets nested over " + std::to_string(kMostNesting) +
                        " deep. This is no glTF that a program would write.");
  }
  try {
    // Without a callback that would leave out images and the like: with one, the parser looks
    // through the whole array again after each object in it.
    const Json root = Json::parse(json.begin(), json.end());
    return Reader(root).read();
  } catch (const MalformedJson& malformed) {
    return bad_input(source, malformed.what);
  } catch (const Json::parse_error& error) {
    return bad_byte(source, offset + std::max<std::size_t>(error.byte, 1) - 1,
                    "not valid JSON. Is the file truncated, or of another format?");
  } catch (const Json::exception&) {
    return bad_input(source, "its JSON has a number that is too large.");
  }
}

}  // namespace fasttree::scene
