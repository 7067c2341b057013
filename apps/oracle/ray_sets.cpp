// SPDX-License-Identifier: Apache-2.0
#include "oracle/ray_sets.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fasttree::oracle {
namespace {

constexpr float kPi = 3.14159265358979f;

std::uint64_t mix(std::uint64_t x) {  // SplitMix64's finaliser
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9u;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace

/// SplitMix64, started from (seed, set, index).
class RayGenerator::Random {
 public:
  Random(std::uint64_t seed, RaySet set, std::uint64_t index)
      : state_(mix(mix(seed + 0x9e3779b97f4a7c15u * (static_cast<std::uint64_t>(set) + 1)) ^
                   mix(index + 0x2545f4914f6cdd1du))) {}

  std::uint64_t next() { return mix(state_ += 0x9e3779b97f4a7c15u); }
  /// Below n, n > 0. The bias is n / 2^64.
  std::uint64_t below(std::uint64_t n) { return next() % n; }
  bool coin() { return (next() >> 63) != 0; }
  /// In [0, 1).
  float unit() { return static_cast<float>(next() >> 40) * 0x1p-24f; }
  /// In [-1, 1).
  float signed_unit() { return 2.0f * unit() - 1.0f; }
  Vec3 direction() {
    const float z = signed_unit();
    const float angle = 2.0f * kPi * unit();
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::uint64_t state_;
};

const char* to_string(RaySet set) {
  switch (set) {
    case RaySet::outside:
      return "outside";
    case RaySet::inside:
      return "inside";
    case RaySet::shadow:
      return "shadow";
    case RaySet::random:
      return "random";
    case RaySet::planes:
      return "planes";
    case RaySet::edges:
      return "edges";
    case RaySet::vertices:
      return "vertices";
    case RaySet::corners:
      return "corners";
    case RaySet::axes:
      return "axes";
    case RaySet::origins:
      return "origins";
    case RaySet::segments:
      return "segments";
  }
  return "unknown";
}

RayGenerator::RayGenerator(const MeshView& mesh, const Tree& tree, std::uint64_t seed)
    : mesh_(mesh), seed_(seed) {
  const Box3 bounds = tree.info().bounds;
  // Halves first: the extent of huge bounds would overflow otherwise.
  centre_ = bounds.lo * 0.5f + bounds.hi * 0.5f;
  half_ = bounds.hi * 0.5f - bounds.lo * 0.5f;
  const float largest = std::max({half_.x, half_.y, half_.z});
  // Flat bounds still get rays on both sides; a single point gets a neighbourhood.
  const float least = largest > 0.0f ? largest * 1e-3f : 1.0f;
  for (std::size_t a = 0; a < 3; ++a) half_[a] = std::max(half_[a], least);
  radius_ = std::max({half_.x, half_.y, half_.z}) * 1.7320508f;

  for (const Node& node : tree.nodes()) {
    if (!node.is_leaf()) splits_[node.axis()].push_back(node.split());
  }
  for (std::size_t a = 0; a < 3; ++a) {
    splits_[a].push_back(bounds.lo[a]);
    splits_[a].push_back(bounds.hi[a]);
    std::sort(splits_[a].begin(), splits_[a].end());
    splits_[a].erase(std::unique(splits_[a].begin(), splits_[a].end()), splits_[a].end());
    splits_[a].shrink_to_fit();
  }
}

void RayGenerator::generate(RaySet set, std::uint64_t first, std::span<Ray> rays) const {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Random random(seed_, set, first + i);
    rays[i] = make(set, random);
  }
}

Vec3 RayGenerator::point_inside(Random& random) const {
  const float x = random.signed_unit();
  const float y = random.signed_unit();
  const float z = random.signed_unit();
  return centre_ + Vec3{half_.x * x, half_.y * y, half_.z * z};
}

Vec3 RayGenerator::point_around(Random& random) const {
  return centre_ + random.direction() * (radius_ * (1.0f + random.unit()));
}

Vec3 RayGenerator::vertex(Random& random) const {
  if (mesh_.triangle_count == 0) return centre_;
  const auto t = static_cast<std::uint32_t>(random.below(mesh_.triangle_count));
  return mesh_.triangle(t)[random.below(3)];
}

Vec3 RayGenerator::point_on_triangle(Random& random) const {
  if (mesh_.triangle_count == 0) return centre_;
  const auto t = static_cast<std::uint32_t>(random.below(mesh_.triangle_count));
  const auto [a, b, c] = mesh_.triangle(t);
  float u = random.unit();
  float v = random.unit();
  if (u + v > 1.0f) {
    u = 1.0f - u;
    v = 1.0f - v;
  }
  return a * (1.0f - u - v) + b * u + c * v;
}

float RayGenerator::split(Random& random, std::size_t axis) const {
  return splits_[axis][random.below(splits_[axis].size())];
}

Vec3 RayGenerator::corner(Random& random) const {
  const float x = split(random, 0);
  const float y = split(random, 1);
  return {x, y, split(random, 2)};
}

Ray RayGenerator::make(RaySet set, Random& random) const {
  Ray ray;
  switch (set) {
    case RaySet::outside: {
      // A dozen cameras round the scene; their rays fill a cone that holds the bounds.
      Random camera(seed_, set, ~random.below(12));
      ray.origin = centre_ + camera.direction() * (2.0f * radius_);
      const Vec3 target = centre_ + random.direction() * (radius_ * random.unit());
      ray.direction = target - ray.origin;
      break;
    }
    case RaySet::inside:
      ray.origin = point_inside(random);
      ray.direction = random.direction();
      break;
    case RaySet::shadow: {
      Random light(seed_, set, ~random.below(4));
      ray.origin = point_on_triangle(random);
      // Half the lights are inside the bounds: the lamps of a room.
      ray.direction = (light.coin() ? point_inside(light) : point_around(light)) - ray.origin;
      ray.t_min = 1e-4f;
      ray.t_max = 1.0f;
      break;
    }
    case RaySet::random:
      ray.origin = point_around(random);
      ray.direction = point_inside(random) - ray.origin;
      break;
    case RaySet::planes: {
      const std::size_t axis = random.below(3);
      ray.origin = random.coin() ? point_inside(random) : point_around(random);
      ray.direction =
          (random.coin() ? point_on_triangle(random) : point_inside(random)) - ray.origin;
      ray.origin[axis] = split(random, axis);
      ray.direction[axis] = random.coin() ? 0.0f : -0.0f;
      break;
    }
    case RaySet::edges: {
      if (mesh_.triangle_count == 0) return ray;
      const auto t = static_cast<std::uint32_t>(random.below(mesh_.triangle_count));
      const auto corners = mesh_.triangle(t);
      const std::size_t i = random.below(3);
      const Vec3 a = corners[i];
      ray.direction = corners[(i + 1) % 3] - a;
      // From the vertex itself, from before it, or from the middle of the edge.
      const float back = random.coin() ? 0.0f : 4.0f * random.signed_unit();
      ray.origin = a - ray.direction * back;
      break;
    }
    case RaySet::vertices: {
      const Vec3 target = vertex(random);
      ray.origin = random.coin()   ? point_around(random)
                   : random.coin() ? vertex(random)
                                   : corner(random);
      ray.direction = target - ray.origin;
      if (random.coin()) ray.t_max = 1.0f;
      break;
    }
    case RaySet::corners: {
      const Vec3 target = corner(random);
      if (random.coin()) {
        // A diagonal of equal components meets the three planes at once, rounding permitting.
        const float s = radius_ * random.unit();
        const Vec3 d{random.coin() ? s : -s, random.coin() ? s : -s, random.coin() ? s : -s};
        ray.origin = target - d;
        ray.direction = d;
      } else {
        ray.origin = random.coin() ? point_around(random) : corner(random);
        ray.direction = target - ray.origin;
      }
      break;
    }
    case RaySet::axes: {
      const std::size_t axis = random.below(3);
      ray.origin = random.coin()   ? vertex(random)
                   : random.coin() ? corner(random)
                                   : point_inside(random);
      ray.direction = {random.coin() ? 0.0f : -0.0f, random.coin() ? 0.0f : -0.0f,
                       random.coin() ? 0.0f : -0.0f};
      const float sign = random.coin() ? 1.0f : -1.0f;
      ray.direction[axis] = sign;
      if (random.coin()) ray.origin[axis] = centre_[axis] - sign * 2.0f * half_[axis];
      break;
    }
    case RaySet::origins: {
      ray.origin = random.coin() ? vertex(random) : point_inside(random);
      const std::size_t axis = random.below(3);
      if (random.coin()) ray.origin[axis] = split(random, axis);
      if (random.coin()) ray.origin = corner(random);
      ray.direction = random.coin() ? random.direction() : vertex(random) - ray.origin;
      break;
    }
    case RaySet::segments: {
      const Vec3 a = random.coin() ? point_inside(random) : point_on_triangle(random);
      ray.origin = point_around(random);
      ray.direction = a - ray.origin;
      // Round t = 1, where the second kind of point lies; sometimes one value of t only.
      const float width = random.coin() ? 0.0f : 0.2f * random.unit();
      const float middle = random.coin() ? 1.0f : 0.5f + random.unit();
      ray.t_min = middle - width;
      ray.t_max = middle + width;
      // An interval may lie behind the origin too.
      if (random.below(16) == 0) {
        ray.direction = ray.direction * -1.0f;
        std::swap(ray.t_min, ray.t_max);
        ray.t_min = -ray.t_min;
        ray.t_max = -ray.t_max;
      }
      break;
    }
  }
  return ray;
}

}  // namespace fasttree::oracle
