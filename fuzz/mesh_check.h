// SPDX-License-Identifier: Apache-2.0
// What every mesh reader promises for any bytes at all, as one check. Used by the fuzzers, by the
// program `mutate`, and by the tests.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "scene/formats/formats.h"

namespace fasttree::fuzz {

struct MeshFormat {
  std::string_view name;  ///< also the name of its corpus folder
  Result<scene::Mesh> (*parse)(const scene::Source&, const scene::LoadSettings&);
};

/// ply, obj, stl, gltf.
std::span<const MeshFormat> mesh_formats();

/// The format of that name, or null.
const MeshFormat* find_mesh_format(std::string_view name);

/// Parses the bytes, copied into memory of exactly their size, and checks: a mesh has only indices
/// that name vertices, positions that can be read, and stays under the memory limit; an error has a
/// message a person can read. Returns what is broken; empty where nothing is.
/// `is_mesh`, where given, says whether the bytes were taken for a mesh.
std::string check_mesh_bytes(const MeshFormat& format, std::span<const std::byte> bytes,
                             bool* is_mesh = nullptr);

/// The body of a libFuzzer target: stops the process where check_mesh_bytes finds something.
int fuzz_mesh_bytes(std::string_view format, const unsigned char* data, std::size_t size);

}  // namespace fasttree::fuzz
