// SPDX-License-Identifier: Apache-2.0
#include "inputs.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "fasttree/tree_file.h"
#include "fasttree/verify.h"
#include "progress.h"

namespace fasttree::app {

std::uint64_t most_of_memory() {
  std::uint64_t bytes = static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PHYS_PAGES))) *
                        static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PAGESIZE)));
  // In a container the group's limit is the one that counts. "max" does not parse and sets nothing.
  for (const char* path :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::uint64_t limit = 0;
    if (std::ifstream file(path); file >> limit) bytes = std::min(bytes, limit);
  }
  return bytes / 5 * 4;
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

const Choices<Profile>& profiles() {
  static const Choices<Profile> choices = {{to_string(Profile::realtime), Profile::realtime},
                                           {to_string(Profile::paper), Profile::paper},
                                           {to_string(Profile::sah_exact), Profile::sah_exact},
                                           {to_string(Profile::sah_binned), Profile::sah_binned}};
  return choices;
}

const Choices<AxisSchedule>& axis_schedules() {
  static const Choices<AxisSchedule> choices = {
      {to_string(AxisSchedule::cyclic), AxisSchedule::cyclic},
      {to_string(AxisSchedule::longest), AxisSchedule::longest}};
  return choices;
}

void BuildOptions::declare(Options& options) {
  settings.memory_limit_bytes = most_of_memory();
  options.choice(settings.profile, "--profile", "Builder", profiles());
  options.choice(settings.axes, "--axes", "Which axis each level halves (profile paper)",
                 axis_schedules());
  options.depth(settings.depth, "--depth", "Levels of the (top) grid (profiles realtime and paper)",
                30);
  options.choice(settings.implementation, "--implementation",
                 "Parallel, or the definition literally (profiles realtime and paper)",
                 Choices<Implementation>{{"fast", Implementation::fast},
                                         {"reference", Implementation::reference}});
  options.choice(settings.simd, "--simd", "Instruction set",
                 Choices<Simd>{{"scalar", Simd::scalar}, {"widest", Simd::widest}});
  options.size(settings.memory_limit_bytes, "--memory-limit",
               "Memory the build may take, such as 512M; 0: no limit",
               bytes_text(settings.memory_limit_bytes));
}

BuildSettings BuildOptions::with_progress(Context& context, const std::string& what) const {
  BuildSettings result = settings;
  result.progress = context.progress.callback(what);
  return result;
}

LoadedScene load_scene(Context& context, const std::string& spec,
                       std::uint64_t memory_limit_bytes) {
  const auto start = std::chrono::steady_clock::now();
  scene::LoadSettings settings;
  settings.memory_limit_bytes = memory_limit_bytes;
  settings.progress = context.progress.callback("reading");
  LoadedScene loaded;
  loaded.mesh = take(scene::load_scene(spec, settings));
  loaded.view = loaded.mesh.view();
  loaded.load_ms = milliseconds_since(start);
  stop_if_cancelled();
  return loaded;
}

Tree load_checked_tree(const std::string& path) {
  Tree tree = take(load_tree(path));
  const Verification verification = verify(tree);
  if (!verification.ok) {
    throw Failure{kBadInput,
                  fmt::format("{}: the tree breaks the invariant '{}': {}; build it anew", path,
                              verification.invariant, verification.detail)};
  }
  return tree;
}

Tracer make_tracer(const Tree& tree, const MeshView& mesh) {
  return take(Tracer::create(tree, mesh));
}

nlohmann::ordered_json json_of(const Vec3& point) {
  return {point.x, point.y, point.z};
}

nlohmann::ordered_json json_of(const Box3& box) {
  return {{"lo", json_of(box.lo)}, {"hi", json_of(box.hi)}};
}

nlohmann::ordered_json json_of(const TreeInfo& info) {
  return {{"profile", to_string(info.profile)},
          {"axes", to_string(info.axes)},
          {"depth", info.depth},
          {"bits", info.bits},
          {"triangles", info.triangle_count},
          {"bounds", json_of(info.bounds)}};
}

nlohmann::ordered_json json_of(const Quality& quality) {
  return {{"nodes", quality.nodes},
          {"inner_nodes", quality.inner_nodes},
          {"leaves", quality.leaves},
          {"empty_leaves", quality.empty_leaves},
          {"references", quality.references},
          {"references_per_triangle", quality.references_per_triangle},
          {"max_depth", quality.max_depth},
          {"mean_leaf_depth", quality.mean_leaf_depth},
          {"max_leaf_size", quality.max_leaf_size},
          {"mean_leaf_size", quality.mean_leaf_size},
          {"leaf_size_histogram", quality.leaf_size_histogram},
          {"expected_inner_steps", quality.expected_inner_steps},
          {"expected_leaf_visits", quality.expected_leaf_visits},
          {"expected_triangle_tests", quality.expected_triangle_tests},
          {"sah_cost", quality.sah_cost}};
}

nlohmann::ordered_json json_of_program() {
  return {{"program", "fasttree"}, {"version", FASTTREE_VERSION}};
}

std::string text_of(const Box3& box) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})", box.lo.x, box.lo.y,
                     box.lo.z, box.hi.x, box.hi.y, box.hi.z);
}

void print_quality(Output& output, const Quality& q) {
  output.line("nodes                {} ({} inner, {} leaves, {} of them empty)",
              with_commas(q.nodes), with_commas(q.inner_nodes), with_commas(q.leaves),
              with_commas(q.empty_leaves));
  output.line("references           {} ({:.3f} a triangle)", with_commas(q.references),
              q.references_per_triangle);
  output.line("leaf depth           mean {:.2f}, at most {}", q.mean_leaf_depth, q.max_depth);
  output.line("leaf size            mean {:.2f}, at most {}", q.mean_leaf_size, q.max_leaf_size);
  output.line("a random line meets  {:.1f} inner nodes, {:.1f} leaves, {:.1f} triangle tests",
              q.expected_inner_steps, q.expected_leaf_visits, q.expected_triangle_tests);
  output.line("SAH cost             {:.1f}", q.sah_cost);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

}  // namespace fasttree::app
