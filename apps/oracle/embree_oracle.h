// SPDX-License-Identifier: Apache-2.0
// A second opinion on rays: Embree, where the program was built with it.
#pragma once

#include <memory>

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/trace.h"

namespace fasttree::oracle {

/// Whether Embree was found when this was built.
bool embree_available();
/// "3.13.5", or "not found".
const char* embree_version();

/// One static triangle mesh in Embree, in its robust mode. Rays may be sent from many threads.
class EmbreeScene {
 public:
  /// Copies the mesh into Embree and builds its hierarchy with the threads of the calling arena.
  /// invalid_argument where Embree is not available; resource_limit where it has no memory.
  /// `fast` asks for Embree's fastest tracing instead of its robust one.
  static Result<EmbreeScene> create(const MeshView& mesh, bool fast = false);

  /// Whether Embree takes the ray: it knows neither negative t nor coordinates over 1.8e18.
  static bool accepts(const Ray& ray);

  /// What Embree finds; nothing for a ray it does not take. Its t is not ours to the bit, and at
  /// (nearly) equal t its triangle may be another one.
  Hit closest(const Ray& ray) const;
  bool occluded(const Ray& ray) const;

  double build_ms() const;

  EmbreeScene(EmbreeScene&&) noexcept;
  EmbreeScene& operator=(EmbreeScene&&) noexcept;
  ~EmbreeScene();

 private:
  struct Impl;
  explicit EmbreeScene(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace fasttree::oracle
