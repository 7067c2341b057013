// SPDX-License-Identifier: Apache-2.0
// Whether a triangle overlaps a cell of a grid: separating axes, in binary32 and in units of cells.
//
// In these units a cell is a cube of side 1 at whole coordinates, so that testing it costs a few
// additions. The test never misses an overlap: rounding of the coordinates, of the planes and of
// the arithmetic here moves nothing by more than kOverlapSlack times the largest coordinate, and
// cells are taken to be that much larger. Operations are in a fixed order and none is fused; the
// vectorised form (src/build/layer_kernels.cpp) has the same ones.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

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
  bool at(float x, float y, float z) const {
    if (!tested_) return true;
    const std::array<float, 3> offset{x, y, z};
    for (std::size_t w = 0; w < 3; ++w) {
      const float u = offset[(w + 1) % 3];
      const float v = offset[(w + 2) % 3];
      for (const Edge& edge : edges_[w]) {
        if ((edge.u * u + edge.v * v) + edge.base < 0.0f) return false;
      }
    }
    const float n = (normal_[0] * x + normal_[1] * y) + normal_[2] * z;
    return !(n + above_ < 0.0f) && !(n + below_ > 0.0f);
  }

 private:
  // An edge seen along an axis: the largest value in a cell of a function that is positive inside
  // the triangle, and zero on the edge.
  struct Edge {
    float u, v, base;
  };

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
    edges_[w][e] = {nu, nv, reach - (nu * from[u] + nv * from[v])};
  }

  void set_plane(const std::array<std::array<float, 3>, 3>& p, float slack) {
    std::array<float, 3> d, e;
    for (std::size_t a = 0; a < 3; ++a) {
      d[a] = p[1][a] - p[0][a];
      e[a] = p[2][a] - p[0][a];
    }
    std::array<float, 3> size;
    for (std::size_t w = 0; w < 3; ++w) {
      const float a = d[(w + 1) % 3] * e[(w + 2) % 3];
      const float b = d[(w + 2) % 3] * e[(w + 1) % 3];
      normal_[w] = a - b;
      size[w] = std::fabs(a) + std::fabs(b);
    }
    const float room = ((size[0] + size[1]) + size[2]) * slack + kOverlapLeast;
    const float at = (normal_[0] * p[0][0] + normal_[1] * p[0][1]) + normal_[2] * p[0][2];
    above_ = (((positive(normal_[0]) + positive(normal_[1])) + positive(normal_[2])) + room) - at;
    below_ = (((negative(normal_[0]) + negative(normal_[1])) + negative(normal_[2])) - room) - at;
  }

  bool tested_ = false;
  std::array<std::array<Edge, 3>, 3> edges_;
  std::array<float, 3> normal_;
  float above_ = 0;
  float below_ = 0;
};

}  // namespace fasttree
