// SPDX-License-Identifier: Apache-2.0
// The scene the benchmarks run on: FASTTREE_BENCH_SCENE in the environment, a mesh file or a
// built-in scene, else a knot of 100,000 triangles.
#pragma once

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "scene/scene.h"

namespace fasttree::bench {

inline const scene::Mesh& bench_scene() {
  static const scene::Mesh mesh = [] {
    const char* spec = std::getenv("FASTTREE_BENCH_SCENE");
    Result<scene::Mesh> loaded = scene::load_scene(spec != nullptr ? spec : "scene:knot:100000");
    if (!loaded.ok()) throw std::runtime_error(loaded.status().message());
    return std::move(loaded).value();
  }();
  return mesh;
}

}  // namespace fasttree::bench
