// SPDX-License-Identifier: Apache-2.0
#include "rtl/engine/rtl_machine.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <utility>

#include "grid/grid.h"
#include "model/memory/byte_store.h"
#include "model/memory/capacity.h"
#include "model/memory/make_memory.h"
#include "model/system/host_interface.h"
#include "model/system/memory_map.h"
#include "rtl/driver/fasttree_accel.h"
#include "rtl/engine/board.h"
#include "rtl/engine/traffic_account.h"
#include "rtl/engine/variants.h"

namespace fasttree::rtl {
namespace {

using model::Address;
using model::SimulationResult;

constexpr std::uint64_t kReportCycles = 20000;
constexpr std::uint32_t kMortonCode = 2;  // of the status register

Status failure(std::uint32_t error, const ft_accel_result& result) {
  const std::string detail = std::to_string(result.error_detail);
  switch (error) {
    case FT_ACCEL_BAD_ORDER:
      return Status(StatusCode::invalid_argument,
                    "the accelerator refused word " + detail + " of its order");
    case FT_ACCEL_SCENE_TOO_LARGE:
      return Status(StatusCode::resource_limit, "the scene is larger than its buffer of " + detail +
                                                    " bytes in the accelerator's memory");
    case FT_ACCEL_NOT_FINITE:
      return Status(StatusCode::bad_input,
                    "coordinate " + std::to_string(result.error_detail % 9) + " of triangle " +
                        std::to_string(result.error_detail / 9) + " is not finite");
    case FT_ACCEL_REFERENCES:
      return Status(StatusCode::resource_limit,
                    "the scene has more references than the " + detail +
                        " that the accelerator's memory has room for. Lower the depth.");
    case FT_ACCEL_LEAVES:
      return Status(StatusCode::resource_limit,
                    "the scene has more leaves than the " + detail +
                        " that the accelerator's memory has room for. Lower the depth.");
    case FT_ACCEL_MEMORY:
      return Status(StatusCode::io_error, "memory answered the accelerator with an error");
    case FT_ACCEL_WINDOW:
      return Status(StatusCode::bad_input, "the accelerator was led to address " + detail +
                                               ", outside its window of memory, and left it alone");
    case FT_ACCEL_CANCELLED:
      return Status(StatusCode::cancelled, "the build was cancelled");
    case FT_ACCEL_TIMEOUT:
      return Status(StatusCode::resource_limit,
                    "the accelerator is stuck: nothing has moved on its bus for the cycles of its "
                    "watchdog");
    default:
      return Status(StatusCode::bad_input,
                    "the accelerator reported error " + std::to_string(error));
  }
}

Result<ft_accel_order> plan(const model::PaperConfig& config, const model::HostOrder& host) {
  const auto depth = static_cast<std::uint32_t>(host.depth);
  if (config.radix_sort.sorted_bits < depth) {
    return Status(StatusCode::invalid_argument, "codes have " + std::to_string(depth) +
                                                    " bits, more than radix_sort_sorted_bits keep");
  }
  ft_accel_order order{};
  const std::uint64_t bytes =
      ft_accel_plan(&order, 0, host.triangles, static_cast<std::uint32_t>(host.references), depth);
  const std::uint64_t limit = std::uint64_t{config.control.memory_mbytes} << 20;
  if (bytes == 0 || bytes > limit) {
    return Status(StatusCode::resource_limit,
                  "the scene does not fit the machine's " + std::to_string(limit) + " bytes (" +
                      std::to_string(host.references) + " references at depth " +
                      std::to_string(depth) +
                      "). Raise control_memory_mbytes (up to 4096) or lower the depth.");
  }
  if (config.grid.axes == AxisSchedule::longest) order.shape |= FT_ACCEL_LONGEST;
  order.rounds = (config.radix_sort.sorted_bits + 3) / 4;
  order.watchdog = config.control.stuck_cycles;
  return order;
}

model::MemoryMap map_of(const ft_accel_order& order) {
  model::MemoryMap map;
  map.scene = Address(order.scene);
  map.pairs[0] = Address(order.pairs0);
  map.pairs[1] = Address(order.pairs1);
  map.sorted_codes = Address(order.sorted_codes);
  map.sorted_ids = Address(order.sorted_ids);
  map.leaf_codes = Address(order.leaf_codes);
  map.leaf_rows = Address(order.leaf_rows);
  map.marks = Address(order.marks);
  map.nodes = Address(order.nodes);
  map.bytes = order.window_end;
  map.mark_bytes = order.mark_bytes;
  return map;
}

Grid grid_of(const ft_accel_order& order, const ft_accel_result& result) {
  Box3 bounds;
  for (std::size_t a = 0; a < 3; ++a) {
    bounds.lo[a] = std::bit_cast<float>(result.lower[a]);
    bounds.hi[a] = std::bit_cast<float>(result.upper[a]);
  }
  const bool longest = (order.shape & FT_ACCEL_LONGEST) != 0;
  return Grid(bounds, longest ? AxisSchedule::longest : AxisSchedule::cyclic,
              static_cast<int>(order.shape & 31u));
}

// Until the build's interrupt: progress, cancelling, limits, waveforms, and the pairs before the
// sort takes their memory.
class Build {
 public:
  Build(Board& board, Top& top, const model::SimulationOptions& options, const RtlOptions& rtl)
      : board_(board), top_(top), options_(options), rtl_(rtl), device_(board.driver()) {}

  Status run(const model::PaperConfig& config, const ft_accel_order& order,
             const model::ByteStore& store, model::IntermediateArrays& arrays) {
    std::uint64_t next_report = 0;
    bool sorted = false;
    bool waving = false;
    while (!board_.irq()) {
      const std::uint64_t cycle = board_.build_cycles();
      if (!rtl_.wave_file.empty() && waving != (cycle >= rtl_.wave_from && cycle < rtl_.wave_to)) {
        waving = !waving;
        if (!waving) top_.close_wave();
        if (waving) {
          if (Status status = top_.open_wave(rtl_.wave_file); !status.ok()) return status;
        }
      }
      board_.step();
      if (options_.keep_arrays && !sorted && board_.stage() > kMortonCode) {
        sorted = true;
        const auto references = device_.read(device_.context, FT_ACCEL_RESULT);
        read_pairs(store, config, Address(order.pairs0), references, arrays);
      }
      if (options_.max_cycles != 0 && cycle > options_.max_cycles) {
        stop(Status(StatusCode::resource_limit,
                    "the run went past its limit of " + std::to_string(options_.max_cycles) +
                        " cycles in stage " + stage_name(board_.stage()) + ". Raise the limit."));
      }
      if (cycle < next_report || !options_.progress) continue;
      next_report = cycle + kReportCycles;
      const double share = static_cast<double>(cycle) / static_cast<double>(expected(order));
      if (!options_.progress(stage_name(board_.stage()), std::min(share, 0.99))) {
        stop(Status(StatusCode::cancelled, std::string("the simulation was cancelled in stage ") +
                                               stage_name(board_.stage())));
      }
    }
    if (waving) top_.close_wave();
    return stopped_;
  }

 private:
  static std::uint64_t expected(const ft_accel_order& order) {
    return std::uint64_t{order.triangles} * 9 + std::uint64_t{order.reference_capacity} * 10 + 5000;
  }
  void stop(Status why) {
    if (!stopped_.ok()) return;
    stopped_ = std::move(why);
    ft_accel_cancel(&device_);
  }

  Board& board_;
  Top& top_;
  const model::SimulationOptions& options_;
  const RtlOptions& rtl_;
  ft_accel device_;
  Status stopped_;
};

}  // namespace

Result<SimulationResult> simulate_rtl(const MeshView& mesh, const model::MachineConfig& config,
                                      const model::SimulationOptions& options,
                                      const RtlOptions& rtl) {
  if (Status status = validate(config.memory); !status.ok()) return status;
  const std::unique_ptr<model::Memory> memory = model::make_memory(config.memory);
  return simulate_rtl(mesh, config, options, rtl, *memory);
}

Result<SimulationResult> simulate_rtl(const MeshView& mesh, const model::MachineConfig& config,
                                      const model::SimulationOptions& options,
                                      const RtlOptions& rtl, model::Memory& memory) {
  const Result<const Variant*> variant = find_variant(config);
  if (!variant.ok()) return variant.status();
  const Result<model::HostOrder> host = prepare_order(mesh, config.paper);
  if (!host.ok()) return host.status();
  Result<ft_accel_order> planned = plan(config.paper, host.value());
  if (!planned.ok()) return planned.status();
  ft_accel_order order = planned.value();
  const model::MemoryMap map = map_of(order);
  if (Status status = check_capacity(memory.traits(), map.bytes); !status.ok()) return status;
  model::ByteStore store(map.bytes);
  write_scene(mesh, map, store);
  if (rtl.tamper) rtl.tamper(order, store);

  const std::unique_ptr<Top> top = variant.value()->make();
  TrafficAccount traffic(map);
  AxiMemoryOptions axi_options;
  axi_options.clock_mhz = config.clock_mhz;
  axi_options.bus_bytes = config.paper.bus.bytes;
  axi_options.commands_per_cycle = config.paper.bus.commands_per_cycle;
  axi_options.wild = rtl.wild_seed != 0;
  axi_options.seed = rtl.wild_seed;
  AxiMemory axi(memory, store, axi_options);
  if (rtl.spoil) rtl.spoil(axi);
  Board board(*top, axi, config, options.timeline_windows, &traffic);
  ft_accel device = board.driver();
  if (ft_accel_probe(&device) != 0) {
    return Status(StatusCode::io_error, "no accelerator answers at the registers");
  }
  device.write(device.context, FT_ACCEL_IRQ_ENABLE, 1);
  ft_accel_start(&device, &order);

  SimulationResult result;
  Build build(board, *top, options, rtl);
  const Status status = build.run(config.paper, order, store, result.arrays);
  if (rtl.inspect) rtl.inspect(store);
  if (!axi.violation().empty()) return Status(StatusCode::bad_input, "AXI: " + axi.violation());
  if (!status.ok()) return status;
  ft_accel_result found;
  ft_accel_read_result(&device, &found);
  board.report(result);
  if (const std::uint32_t error = ft_accel_error(&device); error != FT_ACCEL_OK) {
    return failure(error, found);
  }
  const Grid grid = grid_of(order, found);
  const model::MachineRegisters registers{found.references, found.leaves, found.root};
  if (options.keep_arrays) {
    ft_accel_flush(&device);
    while (ft_accel_busy(&device)) {
    }
    result.arrays.bounds = grid.bounds();
    read_arrays(store, map, registers, read_marks(store, map, grid), result.arrays);
  }
  Result<Tree> tree =
      tree_from_device_image(read_image(store, map, grid, mesh.triangle_count, registers));
  if (!tree.ok() && !options.keep_broken) return tree.status();
  if (top->failed_assertions() > 0) {
    return Status(StatusCode::bad_input, std::to_string(top->failed_assertions()) +
                                             " assertions of the RTL have failed; they are above");
  }

  result.config = config.name;
  result.clock_mhz = config.clock_mhz;
  result.triangles = mesh.triangle_count;
  result.references = found.references;
  result.leaves = found.leaves;
  result.cycles = std::uint64_t{found.cycles_high} << 32 | found.cycles_low;
  result.mark_cache = {found.mark_reads, found.mark_read_hits, found.mark_writes,
                       found.mark_write_hits, found.mark_write_backs};
  result.memory_traits = memory.traits();
  result.memory = memory.statistics();
  if (tree.ok()) {
    result.tree = std::move(tree).value();
  } else {
    result.broken_tree = tree.status().message();
  }
  return result;
}

}  // namespace fasttree::rtl
