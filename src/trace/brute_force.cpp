// SPDX-License-Identifier: Apache-2.0
// Brute force over all triangles, several at once. The vector code computes the three edge
// functions exactly as intersect_triangle() does and only says which triangles they do not rule
// out; those few go through intersect_triangle() itself. Compiled once for every instruction set.
#include <algorithm>
#include <array>
#include <bit>

#include "fasttree/trace.h"
#include "geometry/triangle_intersection.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/brute_force.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#ifndef FASTTREE_BRUTE_FORCE_ONCE
#define FASTTREE_BRUTE_FORCE_ONCE
namespace fasttree {
namespace {

constexpr std::size_t kPadding = 16;  // at least the lanes of any instruction set

}  // namespace

// One coordinate array a corner and (permuted) axis.
struct SoupView {
  std::array<std::array<const float*, 3>, 3> corner;
  std::size_t count;  // rounded up; lanes past the end are points, which are never hit
};

}  // namespace fasttree
#endif

HWY_BEFORE_NAMESPACE();
namespace fasttree {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The first triangle from `first` on that the edge functions do not rule out, or `soup.count`.
std::size_t NextCandidate(const SoupView& soup, const ShearedRay& ray, std::size_t first) {
  const hn::CappedTag<double, 8> dd;
  const hn::Rebind<float, decltype(dd)> df;
  const std::size_t lanes = hn::Lanes(dd);
  const auto sx = hn::Set(df, ray.sx);
  const auto sy = hn::Set(df, ray.sy);
  const auto ox = hn::Set(df, ray.origin[ray.kx]);
  const auto oy = hn::Set(df, ray.origin[ray.ky]);
  const auto oz = hn::Set(df, ray.origin[ray.kz]);
  const auto zero = hn::Zero(dd);
  for (std::size_t i = first - first % lanes; i < soup.count; i += lanes) {
    const auto x = [&](std::size_t c) {
      const auto z = hn::Sub(hn::LoadU(df, soup.corner[c][2] + i), oz);
      return hn::PromoteTo(
          dd, hn::Sub(hn::Sub(hn::LoadU(df, soup.corner[c][0] + i), ox), hn::Mul(sx, z)));
    };
    const auto y = [&](std::size_t c) {
      const auto z = hn::Sub(hn::LoadU(df, soup.corner[c][2] + i), oz);
      return hn::PromoteTo(
          dd, hn::Sub(hn::Sub(hn::LoadU(df, soup.corner[c][1] + i), oy), hn::Mul(sy, z)));
    };
    const auto ax = x(0), bx = x(1), cx = x(2);
    const auto ay = y(0), by = y(1), cy = y(2);
    const auto u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const auto negative = hn::Or(hn::Lt(u, zero), hn::Or(hn::Lt(v, zero), hn::Lt(w, zero)));
    const auto positive = hn::Or(hn::Gt(u, zero), hn::Or(hn::Gt(v, zero), hn::Gt(w, zero)));
    const auto ruled_out =
        hn::Or(hn::And(negative, positive), hn::Eq(hn::Add(hn::Add(u, v), w), zero));
    if (hn::AllTrue(dd, ruled_out)) continue;
    std::uint8_t bits[8] = {};  // at most 8 lanes, so one byte; the store may write more
    hn::StoreMaskBits(dd, hn::Not(ruled_out), bits);
    const unsigned candidates = bits[0] >> (first > i ? first - i : 0);
    if (candidates != 0)
      return std::max(i, first) + static_cast<std::size_t>(std::countr_zero(candidates));
  }
  return soup.count;
}

}  // namespace HWY_NAMESPACE
}  // namespace fasttree
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fasttree {

HWY_EXPORT(NextCandidate);

namespace {

SoupView permuted(const std::vector<float>& coordinates, std::size_t stride,
                  const ShearedRay& ray) {
  SoupView soup;
  soup.count = stride;
  const std::array<std::uint32_t, 3> axes{ray.kx, ray.ky, ray.kz};
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t a = 0; a < 3; ++a) {
      soup.corner[c][a] = coordinates.data() + (3 * c + axes[a]) * stride;
    }
  }
  return soup;
}

}  // namespace

BruteForce::BruteForce(const MeshView& mesh)
    : mesh_(mesh),
      stride_((mesh.triangle_count + kPadding - 1) / kPadding * kPadding),
      coordinates_(9 * stride_, 0.0f) {
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const auto triangle = mesh.triangle(t);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t a = 0; a < 3; ++a) coordinates_[(3 * c + a) * stride_ + t] = triangle[c][a];
    }
  }
}

Hit BruteForce::closest(const Ray& ray) const {
  Hit best;
  const ShearedRay sheared = shear(ray);
  if (!sheared.valid) return best;
  const SoupView soup = permuted(coordinates_, stride_, sheared);
  const auto next = [&](std::size_t first) {
    return HWY_DYNAMIC_DISPATCH(NextCandidate)(soup, sheared, first);
  };
  for (std::size_t i = next(0); i < mesh_.triangle_count; i = next(i + 1)) {
    const auto id = static_cast<std::uint32_t>(i);
    float t, u, v;
    // Ids ascend, so at an equal t the first one stays.
    if (intersect_triangle(sheared, ray.t_min, std::min(ray.t_max, best.t), mesh_.triangle(id), t,
                           u, v) &&
        t < best.t) {
      best = {t, id, u, v};
    }
  }
  return best;
}

bool BruteForce::occluded(const Ray& ray) const {
  const ShearedRay sheared = shear(ray);
  if (!sheared.valid) return false;
  const SoupView soup = permuted(coordinates_, stride_, sheared);
  const auto next = [&](std::size_t first) {
    return HWY_DYNAMIC_DISPATCH(NextCandidate)(soup, sheared, first);
  };
  for (std::size_t i = next(0); i < mesh_.triangle_count; i = next(i + 1)) {
    float t, u, v;
    if (intersect_triangle(sheared, ray.t_min, ray.t_max,
                           mesh_.triangle(static_cast<std::uint32_t>(i)), t, u, v)) {
      return true;
    }
  }
  return false;
}

}  // namespace fasttree
#endif  // HWY_ONCE
