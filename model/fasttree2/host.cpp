// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/host.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>
#include <vector>

#include "model/fasttree2/bucket_walker.h"
#include "model/fasttree2/scene_reader.h"
#include "reference/scene_bound.h"

namespace fasttree::model::ft2 {

namespace {

constexpr std::uint64_t kMemoryBytes = std::uint64_t{4} << 30;  ///< of the addresses' 32 bits

Address place(std::uint64_t& end, std::uint64_t bytes) {
  const Address at(end);
  end = (end + bytes + 4095) / 4096 * 4096;
  return at;
}

// Buckets that are in memory at the same time lie apart in the grid, so their records are no more
// than all references; the bucket that is partitioned again is there twice. Each bucket may leave
// one chunk in part empty, and has one more on order.
std::uint64_t most_chunks(std::uint64_t references, std::uint64_t buckets,
                          const FastTree2Config& config, const ChunkFormat& format) {
  const std::uint64_t live = buckets + BucketWalker::stack_bound(config) + config.sub_buckets +
                             config.ready_buckets + 2ull * config.lanes + 1;
  return 2 * references / format.records_of_chunk() + 2 * live + config.free_chunks;
}

}  // namespace

Status check(const FastTree2Config& c) {
  if (c.chunk_bytes < c.combine_bytes) {
    return {StatusCode::invalid_argument,
            "fasttree2.chunk_bytes (" + std::to_string(c.chunk_bytes) +
                ") is under fasttree2.combine_bytes (" + std::to_string(c.combine_bytes) +
                "); a chunk holds at least one line"};
  }
  return {};
}

Result<HostPlan> make_plan(const MeshView& mesh, const FastTree2Config& config) {
  if (Status status = validate(mesh); !status.ok()) return status;
  if (Status status = check(config); !status.ok()) return status;
  HostPlan plan;
  const Result<Box3> bounds = reference::scene_bound(mesh);
  if (!bounds.ok()) return bounds.status();
  plan.bounds = bounds.value();

  const ReferenceCounts counts = count_references(mesh, plan.bounds, config.axes);
  BuildSettings settings;
  settings.profile = Profile::paper;
  settings.axes = config.axes;
  settings.depth =
      config.depth == FastTree2Config::kDepthByRule ? kAutoDepth : static_cast<int>(config.depth);
  settings.extra_depth = static_cast<int>(config.extra_depth);
  settings.max_growth = config.max_growth;
  const Result<int> depth = choose_depth(counts, mesh.triangle_count, settings);
  if (!depth.ok()) return depth.status();
  plan.depth = depth.value();
  plan.references = counts.at[static_cast<std::size_t>(plan.depth)];

  const Grid grid(plan.bounds, config.axes, plan.depth);
  const CellLevels levels(grid);
  const int bucket_bits = std::min<int>(std::bit_width(config.buckets) - 1, plan.depth);
  ChunkFormat format{config.chunk_bytes, config.combine_bytes, 0};
  format.record_bytes = RecordFormat(mesh.triangle_count, levels.bits_below(bucket_bits)).bytes();

  Layout& l = plan.layout;
  l.chunk_count = most_chunks(plan.references, std::uint64_t{1} << bucket_bits, config, format);
  l.id_slots = plan.references;
  const std::uint64_t leaves =
      std::max<std::uint64_t>(std::min(plan.references, std::uint64_t{1} << plan.depth), 1);
  // A whole number of accesses, so that the last slot ends one.
  l.node_slots = (2 * leaves - 1 + 7) / 8 * 8;
  std::uint64_t end = 0;
  l.scene = place(end, std::uint64_t{mesh.triangle_count} * kTriangleBytes);
  l.chunks = place(end, l.chunk_count * config.chunk_bytes);
  l.spill = place(end, (l.chunk_count + 8) * 4);
  l.nodes = place(end, l.node_slots * sizeof(Node));
  l.ids = place(end, l.id_slots * 4);
  l.bytes = std::max<std::uint64_t>(end, 4096);
  if (l.bytes > kMemoryBytes) {
    return Status(StatusCode::resource_limit,
                  "fasttree-2 would need " + std::to_string(l.bytes) +
                      " bytes of memory for this scene, and its addresses have 32 bits. Ask for a "
                      "smaller depth.");
  }
  return plan;
}

void upload_scene(const MeshView& mesh, Address to, ByteStore& store) {
  for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
    const std::array<Vec3, 3> triangle = mesh.triangle(t);
    static_assert(sizeof triangle == kTriangleBytes);
    store.write(to + Address(std::uint64_t{t} * kTriangleBytes), triangle.data(), kTriangleBytes);
  }
}

Tree download_tree(const ByteStore& store, const Registers& registers, std::uint64_t root) {
  const Layout& l = registers.layout;
  std::vector<Node> nodes(l.node_slots - root);
  store.read(l.nodes + Address(root * sizeof(Node)), nodes.data(), nodes.size() * sizeof(Node));
  for (Node& node : nodes) {
    if (!node.is_leaf()) node.word0 -= static_cast<std::uint32_t>(root) << 2;
  }
  std::vector<std::uint32_t> ids(registers.references);
  store.read(l.ids, ids.data(), ids.size() * 4);
  return Tree(registers.levels.grid().tree_info(registers.triangles), std::move(nodes),
              std::move(ids));
}

}  // namespace fasttree::model::ft2
