// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <cassert>
#include <chrono>
#include <new>
#include <string>

#include "fasttree/trace.h"
#include "geometry/triangle_intersection.h"
#include "trace/traversal.h"
#include "trace/wide_layout.h"
#include "trace/wide_trace.h"

namespace fasttree {
namespace {

constexpr std::size_t kRaysPerTask = 1024;

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

// Whole packets to a task.
template <typename Work>
void for_each_part(std::size_t count, const Work& work) {
  const std::size_t parts = (count + kRaysPerTask - 1) / kRaysPerTask;
  tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
    const std::size_t begin = part * kRaysPerTask;
    work(begin, std::min(kRaysPerTask, count - begin));
  });
}

}  // namespace

struct Tracer::Impl {
  std::span<const Node> nodes;
  std::span<const std::uint32_t> ids;
  Box3 bounds;
  MeshView mesh;
  WideLayout layout;
  double layout_ms = 0;

  // A part of a batch through the wide layout by `trace`; the few rays it leaves go through the
  // kd-tree itself.
  void closest(std::span<const Ray> rays, std::span<Hit> hits, TraceCounters* counters,
               void (*trace)(const WideScene&, const WideBatch&)) const {
    std::vector<std::uint32_t> wild;
    trace({&layout, bounds}, {rays, hits, {}, counters, &wild});
    for (const std::uint32_t i : wild) {
      hits[i] = trace_closest(nodes, ids, bounds, mesh, rays[i], counters);
    }
  }
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> flags, TraceCounters* counters,
                void (*trace)(const WideScene&, const WideBatch&)) const {
    std::vector<std::uint32_t> wild;
    trace({&layout, bounds}, {rays, {}, flags, counters, &wild});
    for (const std::uint32_t i : wild) {
      flags[i] = trace_occluded(nodes, ids, bounds, mesh, rays[i], counters) ? 1 : 0;
    }
  }
};

Tracer::Tracer() : impl_(std::make_unique<Impl>()) {
  static const Tree kEmpty;
  (void)update(kEmpty, {});
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
  if (impl_ == nullptr) *this = Tracer();  // this one was moved from
  const auto start = std::chrono::steady_clock::now();
  try {
    make_wide_layout(tree, mesh, impl_->layout);
  } catch (const std::bad_alloc&) {
    *this = Tracer();
    return Status(StatusCode::resource_limit,
                  "tracer: out of memory for " + std::to_string(tree.ids().size()) +
                      " references. Build a tree with a smaller depth or split the mesh.");
  }
  impl_->nodes = tree.nodes();
  impl_->ids = tree.ids();
  impl_->bounds = tree.info().bounds;
  impl_->mesh = mesh;
  const auto stop = std::chrono::steady_clock::now();
  impl_->layout_ms = std::chrono::duration<double, std::milli>(stop - start).count();
  return {};
}

double Tracer::layout_ms() const {
  return impl_->layout_ms;
}

std::uint64_t Tracer::layout_bytes() const {
  return impl_->layout.bytes();
}

Hit Tracer::closest(const Ray& ray) const {
  Hit hit;
  impl_->closest({&ray, 1}, {&hit, 1}, nullptr, wide_closest);
  return hit;
}

Hit Tracer::closest(const Ray& ray, TraceCounters& counters) const {
  Hit hit;
  impl_->closest({&ray, 1}, {&hit, 1}, &counters, wide_closest);
  return hit;
}

bool Tracer::occluded(const Ray& ray) const {
  std::uint8_t flag = 0;
  impl_->occluded({&ray, 1}, {&flag, 1}, nullptr, wide_occluded);
  return flag != 0;
}

bool Tracer::occluded(const Ray& ray, TraceCounters& counters) const {
  std::uint8_t flag = 0;
  impl_->occluded({&ray, 1}, {&flag, 1}, &counters, wide_occluded);
  return flag != 0;
}

void Tracer::closest(std::span<const Ray> rays, std::span<Hit> hits, RayOrder order) const {
  assert(rays.size() == hits.size());
  const auto trace = order == RayOrder::coherent ? packet_closest : wide_closest;
  for_each_part(rays.size(), [&](std::size_t begin, std::size_t n) {
    impl_->closest(rays.subspan(begin, n), hits.subspan(begin, n), nullptr, trace);
  });
}

void Tracer::occluded(std::span<const Ray> rays, std::span<std::uint8_t> flags,
                      RayOrder order) const {
  assert(rays.size() == flags.size());
  const auto trace = order == RayOrder::coherent ? packet_occluded : wide_occluded;
  for_each_part(rays.size(), [&](std::size_t begin, std::size_t n) {
    impl_->occluded(rays.subspan(begin, n), flags.subspan(begin, n), nullptr, trace);
  });
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
