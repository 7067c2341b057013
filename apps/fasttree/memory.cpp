// SPDX-License-Identifier: Apache-2.0
// fasttree memory: what an off-chip memory gives to a simple load, without a machine beside it.
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "command.h"
#include "inputs.h"
#include "model/config/machine_config.h"
#include "model/memory/command_checker.h"
#include "model/memory/command_trace.h"
#include "model/memory/dram_memory.h"
#include "model/memory/make_memory.h"
#include "model/memory/measure.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "tree/atomic_file.h"

namespace fasttree::app {
namespace {

using namespace model;
using nlohmann::ordered_json;

const Choices<AccessPattern> kPatterns = {{"sequential", AccessPattern::sequential},
                                          {"random", AccessPattern::random},
                                          {"copy", AccessPattern::copy},
                                          {"mixed", AccessPattern::mixed}};

/// Writes a trace to a file that appears when it is whole.
class TraceFile {
 public:
  explicit TraceFile(const std::string& path)
      : file_(take(AtomicFile::create(path))),
        trace_([this](std::string_view text) { write(text); }) {}
  CommandObserver* observer() { return &trace_; }
  void finish() {
    trace_.finish();
    check(status_);
    check(file_.commit());
  }

 private:
  void write(std::string_view text) {
    if (status_.ok()) status_ = file_.write(std::as_bytes(std::span(text)));
  }

  AtomicFile file_;
  CommandTrace trace_;
  Status status_;
};

class MemoryCommand : public Command {
 public:
  const char* name() const override { return "memory"; }
  const char* summary() const override { return "What an off-chip memory gives by itself"; }
  const char* details() const override {
    return "Puts a simple load on the memory of a machine's configuration, or on a memory preset\n"
           "(lpddr3-1600, lpddr3-1600-dual, ddr3-1600, ideal, fixed): bandwidth, latency, row\n"
           "hits. An access of --bytes becomes as many requests as it has bursts. copy reads one\n"
           "stream and writes another; mixed reads and writes at random.\n\n"
           "Example:\n  fasttree memory --config paper-asic65 --pattern random --bytes 64\n"
           "  fasttree memory --config lpddr3-1600 --pattern mixed --trace commands.txt --check";
  }

  void declare(Options& options) override {
    options.text(config_, "--config", "NAME|FILE",
                 "A machine's configuration or a memory preset (lpddr3-1600-dual)");
    options.text(set_, "--set", "KEY=VALUE,...", "Changes keys, such as memory.cl_clocks=14");
    options.choice(load_.pattern, "--pattern", "Which addresses", kPatterns);
    options.choice(load_.write, "--op", "For sequential and random",
                   Choices<bool>{{"read", false}, {"write", true}});
    options.count(load_.bytes, "--bytes", "Bytes of an access, a power of two", 4, 1 << 20);
    options.count(load_.outstanding, "--outstanding", "Requests under way, at most", 1, 1 << 20);
    options.choice(interleave_, "--interleave", "Of the channels",
                   Choices<int>{{"config", -1},
                                {"burst", static_cast<int>(Interleave::burst)},
                                {"row", static_cast<int>(Interleave::row)}});
    options.count(load_.accesses, "--accesses", "How many", 1, 1u << 30);
    options.count(load_.seed, "--seed", "Of random addresses", 0, 1u << 30);
    options.text(trace_path_, "--trace", "FILE", "Write every command of the channels");
    options.flag(check_, "--check", "Check every command against the device's rules");
  }

  int run(Context& context) override {
    const MachineConfig config = configuration();
    if (load_.write && load_.pattern != AccessPattern::sequential &&
        load_.pattern != AccessPattern::random) {
      throw Failure{kUsage, "--op write is for --pattern sequential and random; copy and mixed " +
                                std::string("read and write by themselves")};
    }
    const bool dram = config.memory.kind == MemoryKind::dram;
    if (!dram && (check_ || !trace_path_.empty())) {
      throw Failure{kUsage, "--check and --trace are for memories with commands; '" +
                                config.memory.preset + "' has none"};
    }
    LoadOptions load = load_;
    load.step_ps = dram ? config.memory.dram.tck_ps : 1000;
    if (dram) {
      // Random addresses over the whole memory, up to 2^31 of it.
      load.span_bytes = std::min(config.memory.dram.channel_bytes() * config.memory.dram.channels,
                                 std::uint64_t{1} << 31);
    }

    CommandFanOut observers;
    CommandChecker checker(config.memory.dram, config.memory.controller);
    std::optional<TraceFile> trace;
    if (check_) observers.add(&checker);
    if (!trace_path_.empty()) observers.add(trace.emplace(trace_path_).observer());
    const std::unique_ptr<Memory> memory = make_memory(config.memory);
    if (!observers.empty()) static_cast<DramMemory&>(*memory).observe(&observers);

    const ProgressCallback progress = context.progress.callback("memory");
    const auto begin = std::chrono::steady_clock::now();
    const MemoryMeasurement measured = take(measure_memory(
        *memory, load, [&progress](double fraction) { return progress("load", fraction); }));
    const double wall_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    context.progress.clear();
    if (check_) checker.finish(measured.time.value / config.memory.dram.tck_ps);
    if (trace.has_value()) trace->finish();

    print(context.output, config, *memory, measured);
    ordered_json json = json_of(config, *memory, measured);
    json["wall_ms"] = wall_ms;
    if (check_) tell_violations(context.output, checker, json);
    context.output.json(json, context.common.json);
    return check_ && checker.violation_count() > 0 ? kCheckFailed : kDone;
  }

 private:
  /// A preset's name, a configuration's name or a file, with what --set and --interleave change.
  MachineConfig configuration() const {
    MachineConfig config;
    const std::vector<std::string>& presets = memory_presets();
    if (std::find(presets.begin(), presets.end(), config_) != presets.end()) {
      config.name = config_;
      config.memory = take(memory_preset(config_));
    } else {
      config = take(load_config(config_));
    }
    for (std::size_t from = 0; from < set_.size();) {
      const std::size_t comma = std::min(set_.find(',', from), set_.size());
      check(apply_override(config, set_.substr(from, comma - from)));
      from = comma + 1;
    }
    if (interleave_ >= 0) {
      config.memory.controller.interleave = static_cast<Interleave>(interleave_);
    }
    return config;
  }

  std::string pattern_name() const {
    for (const auto& [name, pattern] : kPatterns) {
      if (pattern == load_.pattern) return name;
    }
    return "";
  }

  void print(Output& output, const MachineConfig& config, const Memory& memory,
             const MemoryMeasurement& measured) const {
    const MemoryTraits& traits = memory.traits();
    const MemoryStatistics& s = memory.statistics();
    const bool both = load_.pattern == AccessPattern::copy || load_.pattern == AccessPattern::mixed;
    output.line("memory               {}, {} channel{}, {} bytes a burst", traits.name,
                traits.channels, traits.channels == 1 ? "" : "s", traits.access_bytes);
    output.line("load                 {}{}, {} bytes an access, {} requests outstanding",
                pattern_name(),
                both          ? ""
                : load_.write ? " writes"
                              : " reads",
                load_.bytes, load_.outstanding);
    if (traits.peak_gb_s > 0) {
      output.line("bandwidth            {:.2f} GB/s, {:.1f} % of {:.1f}", measured.bandwidth_gb_s,
                  100 * measured.bandwidth_gb_s / traits.peak_gb_s, traits.peak_gb_s);
    } else {
      output.line("bandwidth            {:.2f} GB/s", measured.bandwidth_gb_s);
    }
    if (s.reads > 0) output.line("read latency         {:.1f} ns on average", measured.latency_ns);
    output.line("requests             {} reads, {} writes", with_commas(s.reads),
                with_commas(s.writes));
    if (config.memory.kind != MemoryKind::dram) return;
    output.line("rows                 {} hits, {} misses, {} conflicts", with_commas(s.row_hits),
                with_commas(s.row_misses), with_commas(s.row_conflicts));
    output.line("refreshes            {}", with_commas(s.refreshes));
    output.line("turnarounds          {}", with_commas(s.turnarounds));
  }

  ordered_json json_of(const MachineConfig& config, const Memory& memory,
                       const MemoryMeasurement& measured) const {
    const MemoryTraits& traits = memory.traits();
    const MemoryStatistics& s = memory.statistics();
    ordered_json json = json_of_program();
    json["config"] = config.name;
    json["memory"] = {{"name", traits.name},
                      {"channels", traits.channels},
                      {"access_bytes", traits.access_bytes},
                      {"peak_gb_s", traits.peak_gb_s}};
    json["load"] = {{"pattern", pattern_name()},  {"op", load_.write ? "write" : "read"},
                    {"bytes", load_.bytes},       {"outstanding", load_.outstanding},
                    {"accesses", load_.accesses}, {"seed", load_.seed}};
    json["bandwidth_gb_s"] = measured.bandwidth_gb_s;
    json["latency_ns"] = s.reads > 0 ? ordered_json(measured.latency_ns) : ordered_json(nullptr);
    json["time_ms"] = static_cast<double>(measured.time.value) / 1e9;
    json["statistics"] = {{"reads", s.reads},
                          {"writes", s.writes},
                          {"read_bytes", s.read_bytes},
                          {"write_bytes", s.write_bytes},
                          {"row_hits", s.row_hits},
                          {"row_misses", s.row_misses},
                          {"row_conflicts", s.row_conflicts},
                          {"refreshes", s.refreshes},
                          {"turnarounds", s.turnarounds},
                          {"read_latency_8ns", s.read_latency_8ns}};
    return json;
  }

  static void tell_violations(Output& output, const CommandChecker& checker, ordered_json& json) {
    output.line("check                {} commands, {} violation{}", with_commas(checker.commands()),
                with_commas(checker.violation_count()), checker.violation_count() == 1 ? "" : "s");
    ordered_json list = ordered_json::array();
    for (const CommandViolation& violation : checker.violations()) {
      output.line("  {}", violation.text);
      list.push_back({{"rule", violation.rule}, {"text", violation.text}});
    }
    json["check"] = {{"commands", checker.commands()},
                     {"violations", checker.violation_count()},
                     {"first", list}};
  }

  std::string config_ = "lpddr3-1600-dual";
  std::string set_;
  LoadOptions load_;
  int interleave_ = -1;
  std::string trace_path_;
  bool check_ = false;
};

}  // namespace

std::unique_ptr<Command> make_memory_command() {
  return std::make_unique<MemoryCommand>();
}

}  // namespace fasttree::app
