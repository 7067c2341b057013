// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <string>

#include "c_api/handles.h"

using namespace fasttree;
using namespace fasttree::c_api;

namespace {

// Rays that are copied and traced at a time: they stay in the first-level cache.
constexpr std::size_t kBlock = 256;

static_assert(sizeof(ft_ray) == sizeof(Ray) && offsetof(ft_ray, t_min) == offsetof(Ray, t_min) &&
              offsetof(ft_ray, direction) == offsetof(Ray, direction) &&
              offsetof(ft_ray, t_max) == offsetof(Ray, t_max));
static_assert(sizeof(ft_hit) == sizeof(Hit) &&
              offsetof(ft_hit, triangle) == offsetof(Hit, triangle));
static_assert(FT_NO_TRIANGLE == kNoTriangle);

Ray ray_of(const ft_ray& ray) {
  return std::bit_cast<Ray>(ray);
}

void store(const Hit& from, ft_hit& to) {
  to = {from.t, from.triangle, from.u, from.v};
}

Status read_order(const char* call, ft_ray_order from, RayOrder& to) {
  if (from == FT_RAYS_INCOHERENT || from == FT_RAYS_COHERENT) {
    to = from == FT_RAYS_COHERENT ? RayOrder::coherent : RayOrder::incoherent;
    return {};
  }
  return invalid(std::string(call) + ": order is " + std::to_string(static_cast<int>(from)) +
                 "; give FT_RAYS_INCOHERENT or FT_RAYS_COHERENT");
}

// Checks the arguments of a call for many rays and runs trace(rays, first, order) block by block.
template <typename Trace>
Status for_many(const char* call, const ft_tracer* tracer, const ft_ray* rays, std::size_t count,
                ft_ray_order given, const void* results, std::uint32_t threads,
                const Trace& trace) {
  if (tracer == nullptr) return null_pointer(call, "tracer");
  RayOrder order;
  if (Status s = read_order(call, given, order); !s.ok()) return s;
  if (count == 0) return {};
  if (rays == nullptr) return null_pointer(call, "rays");
  if (results == nullptr) return null_pointer(call, "the array of results");
  return on_threads(call, threads, [&]() -> Status {
    tbb::parallel_for(std::size_t{0}, (count + kBlock - 1) / kBlock, [&](std::size_t block) {
      const std::size_t first = block * kBlock;
      std::array<Ray, kBlock> copy;
      const std::span<Ray> some(copy.data(), std::min(kBlock, count - first));
      for (std::size_t i = 0; i < some.size(); ++i) some[i] = ray_of(rays[first + i]);
      trace(some, first, order);
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

ft_status ft_tracer_update(ft_tracer* tracer, const ft_tree* tree, const ft_mesh* mesh,
                           uint32_t threads) {
  return guarded([&]() -> Status {
    constexpr char kCall[] = "ft_tracer_update";
    if (tracer == nullptr) return null_pointer(kCall, "tracer");
    if (tree == nullptr) return null_pointer(kCall, "tree");
    MeshView view;
    if (Status s = read_mesh(kCall, mesh, view); !s.ok()) return s;
    if (Status s = validate(view); !s.ok()) return s;
    return on_threads(kCall, threads, [&]() -> Status {
      if (tree->tree->info().triangle_count != view.triangle_count) {
        return Tracer::create(*tree->tree, view).status();  // says what is wrong
      }
      Status status = tracer->tracer.update(*tree->tree, view);
      // What a failed update leaves needs no tree, and none that is the caller's any more.
      tracer->tree = status.ok() ? tree->tree : nullptr;
      return status;
    });
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
                                 ft_ray_order order, ft_hit* hits, uint32_t threads) {
  return guarded([&] {
    return for_many("ft_tracer_closest_many", tracer, rays, count, order, hits, threads,
                    [&](std::span<const Ray> some, std::size_t first, RayOrder known) {
                      std::array<Hit, kBlock> found;
                      tracer->tracer.closest(some, std::span(found.data(), some.size()), known);
                      for (std::size_t i = 0; i < some.size(); ++i)
                        store(found[i], hits[first + i]);
                    });
  });
}

ft_status ft_tracer_occluded_many(const ft_tracer* tracer, const ft_ray* rays, size_t count,
                                  ft_ray_order order, uint8_t* occluded, uint32_t threads) {
  return guarded([&] {
    return for_many("ft_tracer_occluded_many", tracer, rays, count, order, occluded, threads,
                    [&](std::span<const Ray> some, std::size_t first, RayOrder known) {
                      tracer->tracer.occluded(some, std::span(occluded + first, some.size()),
                                              known);
                    });
  });
}
