// SPDX-License-Identifier: Apache-2.0
// A procedural scene as a list of parametric patches: counted first, made afterwards. Nothing is
// allocated before the whole scene's triangles and vertices are known.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "fasttree/status.h"
#include "scene/scene.h"

namespace fasttree::scene {

/// Scenes are computed in binary64 and rounded once, so that a last-bit difference between two
/// mathematical libraries hardly ever reaches a vertex.
struct Point {
  double x = 0;
  double y = 0;
  double z = 0;
};

inline Point operator+(Point a, Point b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Point operator-(Point a, Point b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Point operator*(Point a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Point cross(Point a, Point b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Point a) {
  return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
}
inline Point lerp(Point a, Point b, double s) {
  return a * (1 - s) + b * s;
}

inline constexpr double kPi = std::numbers::pi;

/// A surface over [0, 1] x [0, 1], cut into nu x nv quads of two triangles. Seen from where u turns
/// counterclockwise into v, the triangles do too.
struct Patch {
  std::function<Point(double u, double v)> at;
  std::uint32_t nu = 1;
  std::uint32_t nv = 1;
  bool wrap_u = false;  ///< u = 1 is u = 0: the vertices are shared
  bool wrap_v = false;
  bool pole_lo = false;  ///< all of v = 0 is one point: one triangle a quad there
  bool pole_hi = false;  ///< the same at v = 1

  std::uint64_t triangles() const;
  std::uint64_t vertices() const;
};

/// Loose triangles, each with vertices of its own.
struct Soup {
  std::function<std::array<Point, 3>(std::uint64_t triangle)> at;
  std::uint64_t count = 0;
};

/// What a patch wants of the triangles there are to share out.
struct Share {
  double weight = 1;         ///< triangles in proportion to this: area times wanted density
  double aspect = 1;         ///< nu / nv
  std::uint32_t min_nu = 1;  ///< never coarser than this
  std::uint32_t min_nv = 1;
  std::uint32_t step_nv = 1;  ///< nv is a multiple of this: for surfaces with creases along u
};

/// Chooses nu and nv for about `triangles`.
void set_resolution(Patch& patch, const Share& share, double triangles);

/// The plan of a scene.
class Plan {
 public:
  /// A patch with the resolution it has.
  void add(Patch patch) { fixed_.push_back(std::move(patch)); }
  /// A patch whose resolution follows from the triangles the scene is asked for.
  void add(Patch patch, const Share& share) { shared_.push_back({std::move(patch), share}); }
  void add(Soup soup) { soups_.push_back(std::move(soup)); }

  /// Sets the resolutions of shared patches, so that the scene has about `triangles`. Shares are
  /// rounded one after the other, each making good for those before it.
  void distribute(std::uint64_t triangles);

  std::uint64_t triangles() const;
  std::uint64_t vertices() const;

  /// Makes the mesh. Call distribute() first. resource_limit: memory or 32-bit vertex indices.
  Result<Mesh> make(std::string name, const LoadSettings& settings) const;

 private:
  std::vector<Patch> fixed_;
  std::vector<std::pair<Patch, Share>> shared_;
  std::vector<Soup> soups_;
};

}  // namespace fasttree::scene
