// SPDX-License-Identifier: Apache-2.0
// Rays a second, one thread: a full picture's primary rays and one shadow ray from each hit.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <vector>

#include "bench_scene.h"
#include "fasttree/build.h"
#include "fasttree/trace.h"

namespace fasttree::bench {
namespace {

constexpr int kWidth = 512;

// From +z at 1.5 diagonals, towards the scene's middle.
std::vector<Ray> primary_rays(const Box3& bounds) {
  const Vec3 centre = (bounds.lo + bounds.hi) * 0.5f;
  const Vec3 extent = bounds.extent();
  const float diagonal = std::sqrt(dot(extent, extent));
  const Vec3 eye = centre + Vec3{0, 0, 1.5f * diagonal};
  std::vector<Ray> rays;
  for (int y = 0; y < kWidth; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / kWidth * 2 - 1;
      const float v = 1 - (static_cast<float>(y) + 0.5f) / kWidth * 2;
      rays.push_back({eye, 0, {0.577f * u, 0.577f * v, -1}});
    }
  }
  return rays;
}

struct Prepared {
  MeshView mesh = bench_scene().view();
  Tree tree;
  std::vector<Ray> primary;
  std::vector<Ray> shadow;

  explicit Prepared(Profile profile) {
    BuildSettings settings;
    settings.profile = profile;
    tree = Builder().build(mesh, settings).value();
    primary = primary_rays(tree.info().bounds);
    const Vec3 light = tree.info().bounds.hi + tree.info().bounds.extent();
    const Tracer tracer = Tracer::create(tree, mesh).value();
    for (const Ray& ray : primary) {
      const Hit hit = tracer.closest(ray);
      if (!hit.hit()) continue;
      const Vec3 point = ray.origin + ray.direction * hit.t;
      shadow.push_back({point, 1e-4f, light - point, 1});
    }
  }
};

void primary(benchmark::State& state, Profile profile) {
  const Prepared p(profile);
  const Tracer tracer = Tracer::create(p.tree, p.mesh).value();
  std::vector<Hit> hits(p.primary.size());
  tbb::task_arena arena(1);
  for (auto _ : state) arena.execute([&] { tracer.closest(p.primary, hits); });
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(p.primary.size()));
}

void shadow(benchmark::State& state, Profile profile) {
  const Prepared p(profile);
  const Tracer tracer = Tracer::create(p.tree, p.mesh).value();
  std::vector<std::uint8_t> flags(p.shadow.size());
  tbb::task_arena arena(1);
  for (auto _ : state) arena.execute([&] { tracer.occluded(p.shadow, flags); });
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(p.shadow.size()));
}

BENCHMARK_CAPTURE(primary, paper, Profile::paper)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(primary, sah_binned, Profile::sah_binned)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(primary, sah_exact, Profile::sah_exact)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(shadow, paper, Profile::paper)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(shadow, sah_binned, Profile::sah_binned)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(shadow, sah_exact, Profile::sah_exact)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fasttree::bench
