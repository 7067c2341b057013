// SPDX-License-Identifier: Apache-2.0
// The mesh readers. All keep the file's order of triangles and vertices, merge nothing, drop no
// degenerate triangle, and check every index. A coordinate that is not a number passes: the builder
// names its triangle. None reads a file but parse_gltf, which may read from Source::folder.
//
// Errors: bad_input, with the line or byte and what to do; resource_limit, before the memory is
// allocated; cancelled; io_error, for an external buffer that cannot be read.
#pragma once

#include "fasttree/status.h"
#include "scene/formats/source.h"
#include "scene/scene.h"

namespace fasttree::scene {

/// PLY 1.0 (Turk 1994): ascii and both binary orders; elements `vertex`, `face` (polygons, cut into
/// fans) and `tristrips` (-1 starts a new strip); everything else is skipped. Little-endian binary
/// positions that are float x, y, z in a row are viewed in place where Source::mapping allows it.
Result<Mesh> parse_ply(const Source& source, const LoadSettings& settings = {});

/// Wavefront OBJ: `v` and `f` (polygons, cut into fans; negative indices; v, v/vt, v//vn, v/vt/vn);
/// other statements are skipped. A face of one or two corners makes no triangle.
Result<Mesh> parse_obj(const Source& source, const LoadSettings& settings = {});

/// STL, binary and ascii: three vertices a triangle, in file order.
Result<Mesh> parse_stl(const Source& source, const LoadSettings& settings = {});

/// glTF 2.0, as JSON or GLB: the default scene's meshes (else the first scene's, else every root
/// node's) with the nodes' transforms, nodes depth first. Points and lines make no triangle. Skins
/// and morph targets are not applied. Compressed geometry is refused.
Result<Mesh> parse_gltf(const Source& source, const LoadSettings& settings = {});

/// Whether the bytes are a binary STL by their size: 84 and 50 a triangle. (The text of an ascii
/// file read as a count would ask for gigabytes, so the two cannot be confused.)
bool has_binary_stl_size(const Source& source);

}  // namespace fasttree::scene
