// SPDX-License-Identifier: Apache-2.0
// Rays through a tree: closest hit and any hit, watertight, equal to brute force bit for bit.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/tree.h"
#include "fasttree/vec.h"

namespace fasttree {

/// Hits are accepted for t_min <= t <= t_max; the point is origin + t * direction. The direction
/// need not have length 1. A ray whose origin or direction is not finite, or whose direction is
/// zero (or so small that its reciprocal overflows), hits nothing.
struct Ray {
  Vec3 origin;
  float t_min = 0.0f;
  Vec3 direction;
  float t_max = std::numeric_limits<float>::infinity();
};

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

/// The nearest hit; at equal t the lowest triangle id. u and v weigh the triangle's second and
/// third vertex.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = kNoTriangle;
  float u = 0.0f;
  float v = 0.0f;

  bool hit() const { return triangle != kNoTriangle; }
  friend bool operator==(const Hit&, const Hit&) = default;
};

/// What is known of the rays of a batch. It changes the time they take, never their results.
enum class RayOrder : std::uint8_t {
  incoherent = 0,  ///< anything: each ray goes its own way
  coherent = 1,  ///< neighbours in the batch start and go nearly alike, as the rays of 8 x 8 pixels
};

/// What tracing cost, for quality figures and heat maps.
struct TraceCounters {
  std::uint64_t inner_steps = 0;
  std::uint64_t leaf_visits = 0;
  std::uint64_t triangle_tests = 0;
};

/// Traces rays through one tree over one mesh. Holds views: tree and mesh have to outlive it, and
/// must not change before the next update(). Thread-safe but for update(). Movable, not copyable.
class Tracer {
 public:
  /// invalid_argument where the tree was not made for a mesh of this many triangles. A tree from
  /// an untrusted file has to pass verify() first.
  static Result<Tracer> create(const Tree& tree, const MeshView& mesh);

  /// A tracer of the empty tree: every ray misses.
  Tracer();
  ~Tracer();
  Tracer(Tracer&&) noexcept;
  Tracer& operator=(Tracer&&) noexcept;

  /// The same as create() in this tracer's memory: for scenes that are rebuilt every frame. Runs on
  /// the threads of the calling task arena. After an error the tracer is that of the empty tree.
  Status update(const Tree& tree, const MeshView& mesh);

  /// Milliseconds of the last create() or update(): part of what a frame's build takes.
  double layout_ms() const;

  /// Bytes of the tracer's own data.
  std::uint64_t layout_bytes() const;

  Hit closest(const Ray& ray) const;
  Hit closest(const Ray& ray, TraceCounters& counters) const;

  /// Whether anything is hit between t_min and t_max.
  bool occluded(const Ray& ray) const;
  bool occluded(const Ray& ray, TraceCounters& counters) const;

  /// Many rays, on the threads of the calling task arena. Spans of equal length. Coherent batches
  /// are traced in packets of 64 neighbours, so put rays of 8 x 8 pixels one after the other.
  void closest(std::span<const Ray> rays, std::span<Hit> hits,
               RayOrder order = RayOrder::incoherent) const;
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> flags,
                RayOrder order = RayOrder::incoherent) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Every triangle tested with the same routine: the judge of every tracer.
Hit brute_force_closest(const MeshView& mesh, const Ray& ray);
bool brute_force_occluded(const MeshView& mesh, const Ray& ray);

/// The same for many rays: the same answers to the bit, about ten times as fast. Copies the
/// triangles (36 bytes each) into an order that vector instructions like. Thread-safe.
class BruteForce {
 public:
  explicit BruteForce(const MeshView& mesh);

  Hit closest(const Ray& ray) const;
  bool occluded(const Ray& ray) const;

 private:
  MeshView mesh_;
  std::size_t stride_ = 0;          ///< triangles, rounded up to whole vectors
  std::vector<float> coordinates_;  ///< [corner][axis][triangle]
};

}  // namespace fasttree
