// SPDX-License-Identifier: Apache-2.0
#include "fuzz/mesh_check.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

namespace fasttree::fuzz {
namespace {

constexpr std::array<MeshFormat, 4> kFormats = {{{"ply", &scene::parse_ply},
                                                 {"obj", &scene::parse_obj},
                                                 {"stl", &scene::parse_stl},
                                                 {"gltf", &scene::parse_gltf}}};

constexpr std::uint64_t kMemoryLimit = 1u << 24;
constexpr const char* kName = "mutant";

std::string check_mesh(const scene::Mesh& mesh, std::span<const std::byte> bytes) {
  if (mesh.indices.size() % 3 != 0) return "indices are no whole triangles";
  const std::uint64_t held =
      mesh.indices.capacity() * sizeof(std::uint32_t) + mesh.positions.capacity() * sizeof(Vec3);
  if (held > kMemoryLimit) return "the mesh is over the memory limit";
  const MeshView view = mesh.view();
  if (view.triangle_count > kMaxTriangles) return "too many triangles";
  if (mesh.mapped_positions != nullptr && view.vertex_count > 0) {
    const auto* const begin = static_cast<const std::byte*>(mesh.mapped_positions);
    const std::size_t end = static_cast<std::size_t>(begin - bytes.data()) +
                            (view.vertex_count - 1) * view.position_stride_bytes + sizeof(Vec3);
    if (begin < bytes.data() || end > bytes.size()) return "positions outside the file";
  }
  for (const std::uint32_t index : mesh.indices) {
    if (index >= view.vertex_count) return "index " + std::to_string(index) + " is out of range";
  }
  // Reads every position, for the sanitizers' sake; the sum is used so that the loop stays.
  std::uint32_t bits = 0;
  for (std::uint32_t v = 0; v < view.vertex_count; ++v) {
    const Vec3 p = view.position(v);
    bits ^= std::bit_cast<std::uint32_t>(p.x) ^ std::bit_cast<std::uint32_t>(p.y) ^
            std::bit_cast<std::uint32_t>(p.z);
  }
  volatile std::uint32_t sink = bits;
  static_cast<void>(sink);
  return "";
}

std::string check_error(const Status& status) {
  const bool expected =
      status.code() == StatusCode::bad_input || status.code() == StatusCode::resource_limit;
  if (!expected) return "status code " + std::to_string(static_cast<unsigned>(status.code()));
  const std::string& message = status.message();
  if (!message.starts_with(kName)) return "the message does not name the file: " + message;
  if (message.size() > 500 || (!message.ends_with('.') && !message.ends_with('?')))
    return "an odd message: " + message;
  for (const char c : message) {
    if (c < 0x20 || c > 0x7e) return "an unprintable character in: " + message;
  }
  return "";
}

}  // namespace

std::span<const MeshFormat> mesh_formats() {
  return kFormats;
}

const MeshFormat* find_mesh_format(std::string_view name) {
  for (const MeshFormat& format : kFormats) {
    if (format.name == name) return &format;
  }
  return nullptr;
}

std::string check_mesh_bytes(const MeshFormat& format, std::span<const std::byte> bytes,
                             bool* is_mesh) {
  // On the heap and no longer than needed, so that AddressSanitizer sees a read past the end.
  const std::shared_ptr<std::byte[]> exact(new std::byte[bytes.size()]);
  if (!bytes.empty()) std::memcpy(exact.get(), bytes.data(), bytes.size());
  scene::Source source;
  source.name = kName;
  source.bytes = {exact.get(), bytes.size()};
  // Every other size with positions viewed in place, so that both ways are tried.
  if (bytes.size() % 2 == 0) source.mapping = exact;
  scene::LoadSettings settings;
  settings.memory_limit_bytes = kMemoryLimit;
  const Result<scene::Mesh> mesh = format.parse(source, settings);
  if (is_mesh != nullptr) *is_mesh = mesh.ok();
  return mesh.ok() ? check_mesh(mesh.value(), source.bytes) : check_error(mesh.status());
}

int fuzz_mesh_bytes(std::string_view format, const unsigned char* data, std::size_t size) {
  const std::string broken =
      check_mesh_bytes(*find_mesh_format(format), std::as_bytes(std::span(data, size)));
  if (!broken.empty()) {
    std::fprintf(stderr, "%s\n", broken.c_str());
    std::abort();
  }
  return 0;
}

}  // namespace fasttree::fuzz
