// SPDX-License-Identifier: Apache-2.0
// Whether a triangle overlaps a cell of a grid: separating axes, in binary32 and in units of cells.
//
// In these units a cell is a cube of side 1 at whole coordinates, so that testing it costs a few
// additions. The test never misses an overlap: rounding of the coordinates, of the planes and of
// the arithmetic here moves nothing by more than kOverlapSlack times the largest coordinate, and
// cells are taken to be that much larger. Operations are in a fixed order and none is fused; the
// vectorised form (src/build/layer_masks.cpp) has the same ones.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "grid/grid.h"

namespace fasttree {

inline constexpr float kOverlapSlack = 0x1p-18f;   ///< 64 units in the last place
inline constexpr float kOverlapLeast = 0x1p-100f;  ///< of a slack: what underflow can lose
inline constexpr float kOverlapLargest = 0x1p20f;  ///< larger triangles overlap everything

/// A triangle's corners in units of the grid's cells.
inline std::array<std::array<float, 3>, 3> in_cells(const Grid& grid,
                                                    const std::array<Vec3, 3>& triangle) {
  std::array<std::array<float, 3>, 3> corners;
  for (std::size_t a = 0; a < 3; ++a) {
    const AxisQuantiser& q = grid.quantiser(a);
    const float finest_to_here = 1.0f / static_cast<float>(1 << (kMaxAxisBits - grid.bits()[a]));
    for (std::size_t c = 0; c < 3; ++c) {
      corners[c][a] = ((triangle[c][a] - q.lo) * q.scale) * finest_to_here;
    }
  }
  return corners;
}

class CellOverlap {
 public:
  /// `corner[c][a]`: corners in units of cells; `origin`: the cell that at() counts from.
  CellOverlap(const std::array<std::array<float, 3>, 3>& corner, const Cell& origin) {
    float largest = 0.0f;
    std::array<std::array<float, 3>, 3> p;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t a = 0; a < 3; ++a) {
        const float size = std::fabs(corner[c][a]);
        largest = largest > size ? largest : size;
        p[c][a] = corner[c][a] - static_cast<float>(origin[a]);
      }
    }
    largest = largest + 1.0f;
    tested_ = largest <= kOverlapLargest;
    const float slack = largest * kOverlapSlack;
    for (std::size_t w = 0; w < 3; ++w) {
      for (std::size_t e = 0; e < 3; ++e) set_edge(p, w, e, slack);
    }
    set_plane(p, slack);
  }

  /// The cell at an offset from the origin.
  bool at(float x, float y, float z) const;

 private:
  // Linear functions of a cell's offset that are negative only where it is outside: the largest
  // value in a cell of a function that is positive inside the triangle and zero on an edge, for the
  // nine edges seen along the axes; and the two sides of the triangle's plane. The last is empty.
  static constexpr std::size_t kLines = 12;

  static float positive(float v) { return v > 0.0f ? v : 0.0f; }
  static float negative(float v) { return v < 0.0f ? v : 0.0f; }

  void set_edge(const std::array<std::array<float, 3>, 3>& p, std::size_t w, std::size_t e,
                float slack) {
    const std::size_t u = (w + 1) % 3, v = (w + 2) % 3;
    const auto& from = p[e];
    const auto& to = p[(e + 1) % 3];
    const auto& third = p[(e + 2) % 3];
    float nu = from[v] - to[v];
    float nv = to[u] - from[u];
    const float side = nu * (third[u] - from[u]) + nv * (third[v] - from[v]);
    if (std::signbit(side)) nu = -nu, nv = -nv;
    const float reach =
        (positive(nu) + positive(nv)) + ((std::fabs(nu) + std::fabs(nv)) * slack + kOverlapLeast);
    const std::size_t line = 3 * w + e;
    const std::array<std::array<float, kLines>*, 3> axis{&x_, &y_, &z_};
    (*axis[u])[line] = nu;
    (*axis[v])[line] = nv;
    base_[line] = reach - (nu * from[u] + nv * from[v]);
  }

  void set_plane(const std::array<std::array<float, 3>, 3>& p, float slack) {
    std::array<float, 3> d, e;
    for (std::size_t a = 0; a < 3; ++a) {
      d[a] = p[1][a] - p[0][a];
      e[a] = p[2][a] - p[0][a];
    }
    std::array<float, 3> size, normal;
    for (std::size_t w = 0; w < 3; ++w) {
      const float a = d[(w + 1) % 3] * e[(w + 2) % 3];
      const float b = d[(w + 2) % 3] * e[(w + 1) % 3];
      normal[w] = a - b;
      size[w] = std::fabs(a) + std::fabs(b);
    }
    const float room = ((size[0] + size[1]) + size[2]) * slack + kOverlapLeast;
    const float at = (normal[0] * p[0][0] + normal[1] * p[0][1]) + normal[2] * p[0][2];
    constexpr std::size_t above = 9, below = 10;
    x_[above] = normal[0], y_[above] = normal[1], z_[above] = normal[2];
    base_[above] =
        (((positive(normal[0]) + positive(normal[1])) + positive(normal[2])) + room) - at;
    // The other side with all signs changed, which changes no rounding.
    x_[below] = -normal[0], y_[below] = -normal[1], z_[below] = -normal[2];
    base_[below] =
        -((((negative(normal[0]) + negative(normal[1])) + negative(normal[2])) - room) - at);
  }

  bool tested_ = false;
  alignas(16) std::array<float, kLines> x_{}, y_{}, z_{}, base_{};
};

}  // namespace fasttree
