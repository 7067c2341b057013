// SPDX-License-Identifier: Apache-2.0
#include "model/system/paper_machine.h"

#include <memory>
#include <utility>

#include "model/memory/byte_store.h"
#include "model/memory/capacity.h"
#include "model/memory/make_memory.h"
#include "model/system/global_control.h"
#include "model/system/host_interface.h"
#include "model/system/memory_map.h"
#include "model/system/paper_units.h"

namespace fasttree::model {
namespace {

// The six steps, as the global control runs them.
class PaperRun {
 public:
  PaperRun(const PaperConfig& config, PaperUnits& units, GlobalControl& control,
           const MemoryMap& map, const HostOrder& order)
      : config_(config), units_(units), control_(control), map_(map), order_(order) {}

  Status scene_bound();
  Status morton_code();
  Status radix_sort();
  Status leaf_node();
  Status internal_node();
  Status path_compression();

  const Grid& grid() const { return grid_; }
  MachineRegisters registers() const {
    return {units_.pair_writer.written(), units_.leaf_node.leaves(),
            units_.path_compression.root()};
  }

 private:
  Status stage(const char* name, const Phase& phase);

  const PaperConfig& config_;
  PaperUnits& units_;
  GlobalControl& control_;
  const MemoryMap& map_;
  HostOrder order_;
  Grid grid_;
};

Status PaperRun::stage(const char* name, const Phase& phase) {
  control_.begin_stage(name);
  control_.pause(config_.control.step_cycles);
  Status status = control_.run(phase);
  control_.end_stage();
  return status;
}

Status PaperRun::scene_bound() {
  units_.scene_reader.start_bounds(map_.scene, order_.triangles,
                                   {&units_.lower_bound.input, &units_.upper_bound.input});
  return stage("scene_bound", units_.bound_phase());
}

// The grid's registers follow from the bounds that the SBCUs found and the D that the host gave.
Status PaperRun::morton_code() {
  Box3 bounds;
  for (std::size_t a = 0; a < 3; ++a) {
    bounds.lo[a] = units_.lower_bound.bound(a);
    bounds.hi[a] = units_.upper_bound.bound(a);
  }
  grid_ = Grid(bounds, config_.grid.axes, order_.depth);
  std::vector<Queue<TriangleJob>*> inputs;
  std::vector<Queue<Pair>*> outputs;
  for (auto& unit : units_.morton_code) {
    unit->set_grid(grid_);
    inputs.push_back(&unit->input);
    outputs.push_back(&unit->output);
  }
  units_.scene_reader.start_triangles(map_.scene, order_.triangles, inputs);
  units_.pair_writer.start(map_.pairs[0], order_.triangles, outputs);
  control_.begin_stage("morton_code");
  control_.pause(config_.control.step_cycles + config_.control.setup_cycles);
  Status status = control_.run(units_.code_phase());
  control_.end_stage();
  return status;
}

Status PaperRun::radix_sort() {
  const std::uint32_t rounds =
      (config_.radix_sort.sorted_bits + config_.radix_sort.radix_bits - 1) /
      config_.radix_sort.radix_bits;
  const Phase phase = units_.sort_phase();
  std::vector<std::uint32_t> counts = units_.pair_writer.digit_counts();
  control_.begin_stage("radix_sort");
  Status status;
  for (std::uint32_t r = 0; r < rounds && status.ok(); ++r) {
    SortRound round;
    round.number = r;
    round.last = r + 1 == rounds;
    round.pairs = units_.pair_writer.written();
    round.from = map_.pairs[r % 2];
    round.to = round.last ? map_.sorted_codes : map_.pairs[(r + 1) % 2];
    round.to_ids = map_.sorted_ids;
    units_.radix_sort.start(round, counts);
    control_.pause(config_.control.step_cycles);
    status = control_.run(phase);
    counts = units_.radix_sort.next_counts();
  }
  control_.end_stage();
  return status;
}

Status PaperRun::leaf_node() {
  units_.leaf_node.start(map_.sorted_codes, units_.pair_writer.written(), map_.leaf_codes,
                         map_.leaf_rows);
  return stage("leaf_node", units_.leaf_phase());
}

// Marks are cleared before the first of them is set.
Status PaperRun::internal_node() {
  const std::uint32_t leaves = units_.leaf_node.leaves();
  const std::uint32_t nodes = leaves > 0 ? leaves - 1 : 0;
  control_.begin_stage("internal_node");
  control_.pause(config_.control.step_cycles);
  units_.bit_encoding.start_clear(map_.marks, map_.mark_bytes);
  Status status = control_.run(units_.clear_phase());
  if (status.ok()) {
    units_.internal_node.start(map_.leaf_codes, leaves);
    units_.split_plane.start(map_.nodes, nodes, grid_);
    units_.bit_encoding.start_marks(map_.marks, nodes);
    control_.pause(config_.control.step_cycles);
    status = control_.run(units_.internal_phase());
  }
  control_.end_stage();
  return status;
}

Status PaperRun::path_compression() {
  units_.path_compression.start(map_.leaf_codes, units_.leaf_node.leaves(), map_.marks, map_.nodes,
                                static_cast<std::uint32_t>(grid_.depth()));
  return stage("path_compression", units_.climb_phase());
}

// What progress is measured by: bytes over the bus, the sort's twice a round.
std::uint64_t expected_cycles(const PaperConfig& config, const HostOrder& order) {
  const std::uint64_t rounds = config.radix_sort.sorted_bits / config.radix_sort.radix_bits + 1;
  return (order.triangles * std::uint64_t{140} + order.references * (2 * rounds + 3) * 9) /
             config.bus.bytes +
         5000;
}

void host_transfer(const PaperConfig& config, GlobalControl& control, const char* name,
                   std::uint64_t bytes) {
  if (!config.control.count_host) return;
  control.begin_stage(name);
  control.pause(bytes / config.control.host_bytes_per_cycle);
  control.end_stage();
}

}  // namespace

Status validate(const PaperConfig& config) {
  const auto refuse = [](const char* what) { return Status(StatusCode::invalid_argument, what); };
  if (config.mark_cache.bytes < config.mark_cache.ways * config.mark_cache.block_bytes) {
    return refuse("mark_cache_bytes is less than one set of mark_cache_ways blocks");
  }
  if (config.bus.read_ahead_bytes < 2 * config.bus.bytes ||
      config.bus.read_ahead_bytes < config.bus.burst_bytes) {
    return refuse("bus_read_ahead_bytes is less than a burst or two bus widths");
  }
  return {};
}

Result<SimulationResult> simulate_paper(const MeshView& mesh, const MachineConfig& config,
                                        const SimulationOptions& options) {
  if (Status status = validate(config.memory); !status.ok()) return status;
  const std::unique_ptr<Memory> memory = make_memory(config.memory);
  return simulate_paper(mesh, config, options, *memory);
}

Result<SimulationResult> simulate_paper(const MeshView& mesh, const MachineConfig& machine,
                                        const SimulationOptions& options, Memory& memory,
                                        const TestHooks& hooks) {
  const PaperConfig& config = machine.paper;
  if (Status status = validate(config); !status.ok()) return status;
  const Result<HostOrder> order = prepare_order(mesh, config);
  if (!order.ok()) return order.status();
  const auto bits = static_cast<std::uint32_t>(order.value().depth);
  if (config.radix_sort.sorted_bits < bits || config.radix_sort.key_bytes * 8 < bits) {
    return Status(StatusCode::invalid_argument,
                  "codes have " + std::to_string(bits) +
                      " bits, more than radix_sort_sorted_bits or radix_sort_key_bytes keep");
  }
  const Result<MemoryMap> map =
      plan_memory(config, mesh.triangle_count, order.value().references, order.value().depth);
  if (!map.ok()) return map.status();
  if (Status status = check_capacity(memory.traits(), map.value().bytes); !status.ok()) {
    return status;
  }

  ByteStore store(map.value().bytes);
  write_scene(mesh, map.value(), store);
  PaperUnits units(config, machine.clock_mhz, memory, store);
  units.bus.drop_beat(hooks.drop_beat);
  if (hooks.wrong_victim) units.mark_cache.break_replacement();
  GlobalControl control(config, units, options, hooks, expected_cycles(config, order.value()));
  PaperRun run(config, units, control, map.value(), order.value());

  SimulationResult result;
  host_transfer(config, control, "host_in", std::uint64_t{mesh.triangle_count} * kTriangleBytes);
  if (Status status = run.scene_bound(); !status.ok()) return status;
  if (Status status = run.morton_code(); !status.ok()) return status;
  if (options.keep_arrays) {
    read_pairs(store, config, map.value().pairs[0], run.registers().references, result.arrays);
  }
  if (Status status = run.radix_sort(); !status.ok()) return status;
  if (Status status = run.leaf_node(); !status.ok()) return status;
  if (Status status = run.internal_node(); !status.ok()) return status;
  if (Status status = run.path_compression(); !status.ok()) return status;

  const MachineRegisters registers = run.registers();
  host_transfer(config, control, "host_out",
                registers.references * 4 + std::uint64_t{registers.leaves} *
                                               (sizeof(DeviceLeaf) + sizeof(DeviceInternalNode)));
  if (options.keep_arrays) {
    std::vector<std::uint8_t> marks = read_marks(store, map.value(), run.grid());
    units.mark_cache.copy_dirty(map.value().marks, marks);
    result.arrays.bounds = run.grid().bounds();
    read_arrays(store, map.value(), registers, marks, result.arrays);
  }
  Result<Tree> tree = tree_from_device_image(
      read_image(store, map.value(), run.grid(), mesh.triangle_count, registers));
  if (!tree.ok() && !options.keep_broken) return tree.status();

  result.config = machine.name;
  result.clock_mhz = machine.clock_mhz;
  result.triangles = mesh.triangle_count;
  result.references = registers.references;
  result.leaves = registers.leaves;
  control.report(result);
  result.mark_cache = units.mark_cache.statistics();
  result.memory_traits = memory.traits();
  result.memory = memory.statistics();
  if (tree.ok()) {
    result.tree = std::move(tree).value();
  } else {
    result.broken_tree = tree.status().message();
  }
  return result;
}

}  // namespace fasttree::model
