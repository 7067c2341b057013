// SPDX-License-Identifier: Apache-2.0
// Embree as the one to measure against: a scene that is rebuilt every frame, and rays in the form
// that Embree traces fastest.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/trace.h"

namespace fasttree::oracle {

/// Embree's build qualities for scenes that change. Its third, high, is for static scenes.
enum class EmbreeQuality : std::uint8_t {
  low,     ///< fastest rebuild: Morton codes
  medium,  ///< its default: binned surface-area heuristic
};

/// How many rays Embree is given at once: a single one, or a packet.
inline constexpr std::array kEmbreeWidths = {1, 8, 16};

/// Rays as Embree wants them, and the place where it puts its hits. Keeps its memory, so that one
/// object serves for many batches. Conversion both ways runs on the threads of the calling arena
/// and is no part of what is measured: a renderer made for Embree has its rays in this form.
class EmbreeRays {
 public:
  EmbreeRays();
  ~EmbreeRays();
  EmbreeRays(EmbreeRays&&) noexcept;
  EmbreeRays& operator=(EmbreeRays&&) noexcept;

  /// Takes over rays, to be traced `width` (one of kEmbreeWidths) at a time. Embree writes into
  /// them, so they have to be set anew before each tracing.
  void set_closest(std::span<const Ray> rays, int width);
  void set_occluded(std::span<const Ray> rays, int width);

  /// What was found, after EmbreePeer::trace(). Spans as long as the rays'.
  void read(std::span<Hit> hits) const;
  void read(std::span<std::uint8_t> flags) const;

 private:
  friend class EmbreePeer;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One triangle mesh in a dynamic Embree scene.
class EmbreePeer {
 public:
  /// Copies the mesh into Embree's own buffers and builds once. invalid_argument where the program
  /// was built without Embree; resource_limit where it has no memory.
  static Result<EmbreePeer> create(const MeshView& mesh, EmbreeQuality quality);

  EmbreePeer(EmbreePeer&&) noexcept;
  EmbreePeer& operator=(EmbreePeer&&) noexcept;
  ~EmbreePeer();

  /// What a renderer does when vertices have moved: marks the vertices as changed and commits
  /// geometry and scene, on the threads of the calling arena, in memory that Embree kept.
  Status rebuild();

  /// Traces all rays in chunks of about 256 on the threads of the calling arena. `coherent` tells
  /// Embree that the rays of a packet start and go nearly alike.
  void trace(EmbreeRays& rays, bool coherent) const;

 private:
  struct Impl;
  explicit EmbreePeer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace fasttree::oracle
