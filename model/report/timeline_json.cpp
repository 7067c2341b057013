// SPDX-License-Identifier: Apache-2.0
#include "model/report/timeline_json.h"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "model/report/account.h"
#include "model/report/text.h"

namespace fasttree::model {
namespace {

// Events are text that is put together here: a library's tree of them would take many times the
// memory.
class Trace {
 public:
  explicit Trace(double clock_mhz) : clock_mhz_(clock_mhz) {}

  void name(const char* what, int track, const std::string& text) {
    event("M", what, track);
    text_ += ",\"args\":{\"name\":" + quoted(text) + "}}";
  }
  void order(int track) {
    event("M", "thread_sort_index", track);
    text_ += ",\"args\":{\"sort_index\":" + std::to_string(track) + "}}";
  }
  /// `args`: members of a JSON object.
  void slice(int track, const std::string& name, std::uint64_t begin, std::uint64_t end,
             const std::string& args) {
    event("X", name, track);
    // Both ends are rounded, so that neighbours meet.
    text_ += ",\"ts\":" + microseconds(nanoseconds(begin)) +
             ",\"dur\":" + microseconds(nanoseconds(end) - nanoseconds(begin)) + ",\"args\":{" +
             args + "}}";
  }
  void counter(const std::string& name, std::uint64_t cycle, const std::string& value) {
    event("C", name, 0);
    text_ += ",\"ts\":" + microseconds(nanoseconds(cycle)) + ",\"args\":{\"value\":" + value + "}}";
  }

  std::string finish() && {
    return "{\"displayTimeUnit\":\"ns\",\"traceEvents\":[" + text_ + "\n]}\n";
  }

 private:
  static std::string quoted(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  std::uint64_t nanoseconds(std::uint64_t cycle) const {
    return static_cast<std::uint64_t>(std::llround(static_cast<double>(cycle) * 1000 / clock_mhz_));
  }
  static std::string microseconds(std::uint64_t ns) {
    const std::string part = std::to_string(ns % 1000);
    return std::to_string(ns / 1000) + "." + std::string(3 - part.size(), '0') + part;
  }
  void event(const char* phase, const std::string& name, int track) {
    text_ += (text_.empty() ? "\n{\"ph\":\"" : ",\n{\"ph\":\"") + std::string(phase) +
             "\",\"pid\":1,\"tid\":" + std::to_string(track) + ",\"name\":" + quoted(name);
  }

  double clock_mhz_;
  std::string text_;
};

enum class State { idle, busy, stalled };

State mostly(std::uint64_t busy, std::uint64_t stalled, std::uint64_t cycles) {
  const std::uint64_t idle = cycles - busy - stalled;
  if (busy >= stalled && busy >= idle) return State::busy;
  return stalled >= idle ? State::stalled : State::idle;
}

void stage_track(const SimulationResult& result, Trace& trace) {
  trace.name("thread_name", 1, "stages");
  trace.order(1);
  for (const StageRecord& stage : result.stages) {
    trace.slice(1, stage.name, stage.begin_cycle, stage.end_cycle,
                "\"cycles\":" + std::to_string(cycles_of(stage)) +
                    ",\"read_bytes\":" + std::to_string(read_bytes(stage)) +
                    ",\"write_bytes\":" + std::to_string(write_bytes(stage)));
  }
}

// Neighbouring windows with the same state are one slice.
void unit_track(const SimulationResult& result, std::size_t u, Trace& trace) {
  const int track = static_cast<int>(u) + 2;
  trace.name("thread_name", track, result.units[u].name);
  trace.order(track);
  State state = State::idle;
  std::uint64_t begin = 0, end = 0, busy = 0, stalled = 0;
  const auto close = [&] {
    if (state == State::idle || end == begin) return;
    trace.slice(track, state == State::busy ? "busy" : "stalled", begin, end,
                "\"busy_cycles\":" + std::to_string(busy) +
                    ",\"stalled_cycles\":" + std::to_string(stalled) +
                    ",\"idle_cycles\":" + std::to_string(end - begin - busy - stalled));
  };
  for (const TimelineSample& sample : result.timeline) {
    const State now = mostly(sample.busy_cycles[u], sample.stalled_cycles[u], sample.cycles);
    if (now != state || sample.begin_cycle != end) {
      close();
      state = now;
      begin = sample.begin_cycle;
      busy = stalled = 0;
    }
    end = sample.begin_cycle + sample.cycles;
    busy += sample.busy_cycles[u];
    stalled += sample.stalled_cycles[u];
  }
  close();
}

// A counter keeps its value until the next one: only changes are written.
void busy_counter(const SimulationResult& result, std::size_t u, Trace& trace) {
  const std::string name = result.units[u].name + " busy %";
  std::string last;
  const auto put = [&](std::uint64_t cycle, const std::string& value) {
    if (value != last) trace.counter(name, cycle, value);
    last = value;
  };
  for (const TimelineSample& sample : result.timeline) {
    put(sample.begin_cycle, fixed(100.0 * sample.busy_cycles[u] / sample.cycles, 1));
  }
  put(result.cycles, "0.0");
}

}  // namespace

std::string timeline_json(const SimulationReport& report) {
  const SimulationResult& result = report.result;
  Trace trace(result.clock_mhz);
  trace.name("process_name", 0, result.config + ": " + report.scene);
  stage_track(result, trace);
  for (std::size_t u = 0; u < result.units.size(); ++u) unit_track(result, u, trace);
  for (const TimelineSample& sample : result.timeline) {
    trace.counter("bandwidth GB/s", sample.begin_cycle,
                  fixed(gb_per_s(result, sample.bus_bytes, sample.cycles), 3));
  }
  trace.counter("bandwidth GB/s", result.cycles, "0");
  for (std::size_t u = 0; u < result.units.size(); ++u) busy_counter(result, u, trace);
  return std::move(trace).finish();
}

}  // namespace fasttree::model
