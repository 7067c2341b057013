// SPDX-License-Identifier: Apache-2.0
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cassert>
#include <string>

#include "fasttree/trace.h"
#include "geometry/triangle_intersection.h"
#include "trace/traversal.h"

namespace fasttree {
namespace {

constexpr std::size_t kRaysPerTask = 256;

// Nearest t wins; equal t: the lowest id. Because every candidate is compared so, the order in
// which triangles are tested does not matter.
void test_closest(const ShearedRay& sheared, float t_min, const std::array<Vec3, 3>& triangle,
                  std::uint32_t id, float t_max, Hit& best) {
  float t, u, v;
  if (!intersect_triangle(sheared, t_min, t_max, triangle, t, u, v)) return;
  if (t < best.t || (t == best.t && id < best.triangle)) best = {t, id, u, v};
}

Hit trace_closest(std::span<const Node> nodes, std::span<const std::uint32_t> ids,
                  const Box3& bounds, const MeshView& mesh, const Ray& ray,
                  TraceCounters* counters) {
  Hit best;
  const ShearedRay sheared = shear(ray);
  if (!sheared.valid) return best;
  traverse(nodes, bounds, ray, counters, [&](const Node& node, float& nearest) {
    for (std::uint32_t i = node.first(), end = i + node.count(); i < end; ++i) {
      test_closest(sheared, ray.t_min, mesh.triangle(ids[i]), ids[i], nearest, best);
      nearest = std::min(nearest, best.t);
    }
    return false;
  });
  return best;
}

bool trace_occluded(std::span<const Node> nodes, std::span<const std::uint32_t> ids,
                    const Box3& bounds, const MeshView& mesh, const Ray& ray,
                    TraceCounters* counters) {
  const ShearedRay sheared = shear(ray);
  if (!sheared.valid) return false;
  bool found = false;
  traverse(nodes, bounds, ray, counters, [&](const Node& node, float&) {
    for (std::uint32_t i = node.first(), end = i + node.count(); i < end && !found; ++i) {
      float t, u, v;
      found = intersect_triangle(sheared, ray.t_min, ray.t_max, mesh.triangle(ids[i]), t, u, v);
    }
    return found;
  });
  return found;
}

template <typename Work>
void for_each_ray(std::size_t count, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kRaysPerTask),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) work(i);
                    });
}

}  // namespace

struct Tracer::Impl {
  std::span<const Node> nodes;
  std::span<const std::uint32_t> ids;
  Box3 bounds;
  MeshView mesh;
  double layout_ms = 0;
};

Tracer::Tracer() : impl_(std::make_unique<Impl>()) {
  static constexpr Node kEmpty = Node::leaf(0, 0);
  impl_->nodes = {&kEmpty, 1};
}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

Result<Tracer> Tracer::create(const Tree& tree, const MeshView& mesh) {
  Tracer tracer;
  if (Status status = tracer.update(tree, mesh); !status.ok()) return status;
  return tracer;
}

Status Tracer::update(const Tree& tree, const MeshView& mesh) {
  if (tree.info().triangle_count != mesh.triangle_count) {
    *this = Tracer();
    return Status(StatusCode::invalid_argument,
                  "tracer: the tree was built for " + std::to_string(tree.info().triangle_count) +
                      " triangles, the mesh has " + std::to_string(mesh.triangle_count) +
                      ". Give the mesh the tree was built for.");
  }
  impl_->nodes = tree.nodes();
  impl_->ids = tree.ids();
  impl_->bounds = tree.info().bounds;
  impl_->mesh = mesh;
  return {};
}

double Tracer::layout_ms() const {
  return impl_->layout_ms;
}

std::uint64_t Tracer::layout_bytes() const {
  return 0;
}

Hit Tracer::closest(const Ray& ray) const {
  return trace_closest(impl_->nodes, impl_->ids, impl_->bounds, impl_->mesh, ray, nullptr);
}

Hit Tracer::closest(const Ray& ray, TraceCounters& counters) const {
  return trace_closest(impl_->nodes, impl_->ids, impl_->bounds, impl_->mesh, ray, &counters);
}

bool Tracer::occluded(const Ray& ray) const {
  return trace_occluded(impl_->nodes, impl_->ids, impl_->bounds, impl_->mesh, ray, nullptr);
}

bool Tracer::occluded(const Ray& ray, TraceCounters& counters) const {
  return trace_occluded(impl_->nodes, impl_->ids, impl_->bounds, impl_->mesh, ray, &counters);
}

void Tracer::closest(std::span<const Ray> rays, std::span<Hit> hits, RayOrder) const {
  assert(rays.size() == hits.size());
  for_each_ray(rays.size(), [&](std::size_t i) { hits[i] = closest(rays[i]); });
}

void Tracer::occluded(std::span<const Ray> rays, std::span<std::uint8_t> flags, RayOrder) const {
  assert(rays.size() == flags.size());
  for_each_ray(rays.size(), [&](std::size_t i) { flags[i] = occluded(rays[i]) ? 1 : 0; });
}

Hit brute_force_closest(const MeshView& mesh, const Ray& ray) {
  Hit best;
  const ShearedRay sheared = shear(ray);
  if (!sheared.valid) return best;
  for (std::uint32_t id = 0; id < mesh.triangle_count; ++id) {
    test_closest(sheared, ray.t_min, mesh.triangle(id), id, std::min(ray.t_max, best.t), best);
  }
  return best;
}

bool brute_force_occluded(const MeshView& mesh, const Ray& ray) {
  const ShearedRay sheared = shear(ray);
  if (!sheared.valid) return false;
  for (std::uint32_t id = 0; id < mesh.triangle_count; ++id) {
    float t, u, v;
    if (intersect_triangle(sheared, ray.t_min, ray.t_max, mesh.triangle(id), t, u, v)) return true;
  }
  return false;
}

}  // namespace fasttree
