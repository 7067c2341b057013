// SPDX-License-Identifier: Apache-2.0
// The stages of profile `paper`'s fast builder one by one, on one thread, in memory that is kept:
// what a frame of a sequence takes.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <vector>

#include "bench_scene.h"
#include "build/buckets.h"
#include "build/node_emission.h"
#include "build/triangle_boxes.h"
#include "build/vertex_codes.h"
#include "fasttree/build.h"
#include "grid/grid.h"

namespace fasttree::bench {
namespace {

using namespace fasttree::build;  // NOLINT: this file is about that namespace

// All that the stages hand on to each other.
struct Stages {
  MeshView mesh = bench_scene().view();
  TreeInfo info;
  AxisLevels levels;
  Grid grid;
  VertexEncoder encoder;
  BucketGrid bucket_grid;
  Buffer<std::uint32_t> codes;
  Buffer<CodeBox> boxes;
  Buckets buckets;
  std::vector<std::uint32_t> ids;
  build::Buffer<std::uint32_t> first_node_of_bucket;
  build::Buffer<Node> nodes;

  Stages()
      : info(Builder().build(mesh).value().info()),
        levels(make_axis_levels(info.bounds, info.axes)),
        grid(info.bounds, info.axes, info.depth),
        encoder(info.bounds, levels, info.depth),
        bucket_grid(encoder.axes) {
    vertices(Simd::widest);
    triangles(Simd::widest);
    count(Simd::widest);
    place(Simd::widest);
    sort(Simd::widest);
    emit(Simd::widest);
  }

  void bounds(Simd simd) {
    Box3 box;
    benchmark::DoNotOptimize(vertex_bounds(mesh, {}, simd, box));
  }
  void vertices(Simd simd) { encode_vertices(mesh, encoder, simd, codes); }
  void triangles(Simd simd) { box_triangles(mesh, info.bounds, codes, encoder.axes, simd, boxes); }
  void count(Simd simd) { count_records(boxes, bucket_grid, simd, buckets); }
  void place(Simd simd) { place_records(boxes, bucket_grid, simd, buckets); }
  void sort(Simd simd) {
    ids.resize(buckets.reference_begin.back());
    sort_buckets(bucket_grid, simd, buckets, ids);
  }
  void emit(Simd) { emit_tree(bucket_grid, buckets, grid, first_node_of_bucket, nodes); }
};

void stage(benchmark::State& state, void (Stages::*run)(Simd)) {
  static Stages stages;
  const auto simd = static_cast<Simd>(state.range(0));
  tbb::task_arena arena(1);
  for (auto _ : state) {
    // Placing moves the counters that counting made.
    if (run == &Stages::place) {
      state.PauseTiming();
      arena.execute([&] { stages.count(simd); });
      state.ResumeTiming();
    }
    arena.execute([&] { (stages.*run)(simd); });
  }
  state.SetItemsProcessed(state.iterations() * stages.mesh.triangle_count);
}

void both(benchmark::internal::Benchmark* b) {
  b->ArgName("widest")->Arg(0)->Arg(1)->UseRealTime()->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(stage, vertex_bounds, &Stages::bounds)->Apply(both);
BENCHMARK_CAPTURE(stage, encode_vertices, &Stages::vertices)->Apply(both);
BENCHMARK_CAPTURE(stage, box_triangles, &Stages::triangles)->Apply(both);
BENCHMARK_CAPTURE(stage, count_records, &Stages::count)->Apply(both);
BENCHMARK_CAPTURE(stage, place_records, &Stages::place)->Apply(both);
BENCHMARK_CAPTURE(stage, sort_buckets, &Stages::sort)->Apply(both);
BENCHMARK_CAPTURE(stage, emit_tree, &Stages::emit)->Apply(both);

}  // namespace
}  // namespace fasttree::bench
