// SPDX-License-Identifier: Apache-2.0
// Building, by builder and number of threads; and the reference's steps one by one.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "bench_scene.h"
#include "fasttree/build.h"
#include "reference/radix_sort.h"
#include "reference/reference_build.h"
#include "reference/scene_bound.h"

namespace fasttree::bench {
namespace {

void build(benchmark::State& state, Profile profile, Implementation implementation, Simd simd) {
  const MeshView mesh = bench_scene().view();
  BuildSettings settings;
  settings.profile = profile;
  settings.implementation = implementation;
  settings.simd = simd;
  Builder builder;
  Tree tree;
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    const Status status = arena.execute([&] { return builder.build(mesh, settings, tree); });
    if (!status.ok()) state.SkipWithError(status.message().c_str());
  }
  state.SetItemsProcessed(state.iterations() * mesh.triangle_count);
}

constexpr auto kFast = Implementation::fast;
constexpr auto kReference = Implementation::reference;
BENCHMARK_CAPTURE(build, paper, Profile::paper, kFast, Simd::widest)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build, paper_scalar, Profile::paper, kFast, Simd::scalar)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build, paper_reference, Profile::paper, kReference, Simd::scalar)
    ->ArgName("threads")
    ->Arg(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build, sah_binned, Profile::sah_binned, kFast, Simd::widest)
    ->ArgName("threads")
    ->Arg(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build, sah_exact, Profile::sah_exact, kFast, Simd::widest)
    ->ArgName("threads")
    ->Arg(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// What each step of the reference takes, from arrays that the steps before it made.
struct Steps {
  MeshView mesh = bench_scene().view();
  reference::ReferenceBuild built;
  Steps() {
    BuildStats stats;
    built = reference::build(mesh, {}, stats).value();
  }
};

const Steps& steps() {
  static const Steps s;
  return s;
}

void scene_bound(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(reference::scene_bound(steps().mesh));
}
void morton_code(benchmark::State& state) {
  const auto& b = steps().built;
  for (auto _ : state) {
    benchmark::DoNotOptimize(reference::morton_code(steps().mesh, b.grid, b.references.size()));
  }
}
void radix_sort(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(reference::radix_sort(steps().built.references));
}
void leaf_node(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(reference::leaf_node(steps().built.sorted));
}
void internal_node(benchmark::State& state) {
  const auto& b = steps().built;
  for (auto _ : state) benchmark::DoNotOptimize(reference::internal_node(b.leaves, b.grid));
}
void bit_encoding(benchmark::State& state) {
  const auto& b = steps().built;
  for (auto _ : state) {
    benchmark::DoNotOptimize(reference::bit_encoding(b.internal, b.grid.depth()));
  }
}
void path_compression(benchmark::State& state) {
  const auto& b = steps().built;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        reference::path_compression(b.leaves, b.internal, b.essential, b.grid.depth()));
  }
}
BENCHMARK(scene_bound)->Unit(benchmark::kMillisecond);
BENCHMARK(morton_code)->Unit(benchmark::kMillisecond);
BENCHMARK(radix_sort)->Unit(benchmark::kMillisecond);
BENCHMARK(leaf_node)->Unit(benchmark::kMillisecond);
BENCHMARK(internal_node)->Unit(benchmark::kMillisecond);
BENCHMARK(bit_encoding)->Unit(benchmark::kMillisecond);
BENCHMARK(path_compression)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fasttree::bench
