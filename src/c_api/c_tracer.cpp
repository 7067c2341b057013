// SPDX-License-Identifier: Apache-2.0
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "c_api/handles.h"

using namespace fasttree;
using namespace fasttree::c_api;

namespace {

constexpr std::size_t kRaysPerTask = 256;

Ray ray_of(const ft_ray& r) {
  return {{r.origin[0], r.origin[1], r.origin[2]},
          r.t_min,
          {r.direction[0], r.direction[1], r.direction[2]},
          r.t_max};
}

void store(const Hit& from, ft_hit& to) {
  to = {from.t, from.triangle, from.u, from.v};
}

static_assert(FT_NO_TRIANGLE == kNoTriangle);

// Checks the arguments of a call for many rays and runs one(i) for each.
template <typename One>
Status for_many(const char* call, const ft_tracer* tracer, const ft_ray* rays, std::size_t count,
                const void* results, std::uint32_t threads, const One& one) {
  if (tracer == nullptr) return null_pointer(call, "tracer");
  if (count == 0) return {};
  if (rays == nullptr) return null_pointer(call, "rays");
  if (results == nullptr) return null_pointer(call, "the array of results");
  return on_threads(call, threads, [&]() -> Status {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kRaysPerTask),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t i = range.begin(); i < range.end(); ++i) one(i);
                      });
    return {};
  });
}

}  // namespace

ft_status ft_tracer_create(const ft_tree* tree, const ft_mesh* mesh, ft_tracer** tracer) {
  return guarded([&]() -> Status {
    constexpr char kCall[] = "ft_tracer_create";
    if (tracer == nullptr) return null_pointer(kCall, "tracer");
    *tracer = nullptr;
    if (tree == nullptr) return null_pointer(kCall, "tree");
    MeshView view;
    if (Status s = read_mesh(kCall, mesh, view); !s.ok()) return s;
    if (Status s = validate(view); !s.ok()) return s;
    Result<Tracer> result = Tracer::create(*tree->tree, view);
    if (!result.ok()) return result.status();
    *tracer = new ft_tracer{tree->tree, std::move(result).value()};
    return {};
  });
}

void ft_tracer_free(ft_tracer* tracer) {
  delete tracer;
}

ft_status ft_tracer_closest(const ft_tracer* tracer, const ft_ray* ray, ft_hit* hit) {
  return guarded([&]() -> Status {
    if (tracer == nullptr) return null_pointer("ft_tracer_closest", "tracer");
    if (ray == nullptr) return null_pointer("ft_tracer_closest", "ray");
    if (hit == nullptr) return null_pointer("ft_tracer_closest", "hit");
    store(tracer->tracer.closest(ray_of(*ray)), *hit);
    return {};
  });
}

ft_status ft_tracer_occluded(const ft_tracer* tracer, const ft_ray* ray, uint8_t* occluded) {
  return guarded([&]() -> Status {
    if (tracer == nullptr) return null_pointer("ft_tracer_occluded", "tracer");
    if (ray == nullptr) return null_pointer("ft_tracer_occluded", "ray");
    if (occluded == nullptr) return null_pointer("ft_tracer_occluded", "occluded");
    *occluded = tracer->tracer.occluded(ray_of(*ray)) ? 1 : 0;
    return {};
  });
}

ft_status ft_tracer_closest_many(const ft_tracer* tracer, const ft_ray* rays, size_t count,
                                 ft_hit* hits, uint32_t threads) {
  return guarded([&] {
    return for_many(
        "ft_tracer_closest_many", tracer, rays, count, hits, threads,
        [&](std::size_t i) { store(tracer->tracer.closest(ray_of(rays[i])), hits[i]); });
  });
}

ft_status ft_tracer_occluded_many(const ft_tracer* tracer, const ft_ray* rays, size_t count,
                                  uint8_t* occluded, uint32_t threads) {
  return guarded([&] {
    return for_many(
        "ft_tracer_occluded_many", tracer, rays, count, occluded, threads,
        [&](std::size_t i) { occluded[i] = tracer->tracer.occluded(ray_of(rays[i])) ? 1 : 0; });
  });
}
