// SPDX-License-Identifier: Apache-2.0
#include "model/memory/measure.h"

#include <algorithm>
#include <bit>

namespace fasttree::model {
namespace {

/// The addresses of a load, request by request.
class Load {
 public:
  Load(const LoadOptions& options, std::uint32_t burst)
      : options_(options), burst_(std::min(burst, options.bytes)), random_(options.seed) {
    start();
  }

  bool finished() const { return access_ == options_.accesses; }
  std::uint64_t access() const { return access_; }
  MemoryRequest next() const { return {Address(base_ + offset_), burst_, write_, 0}; }

  void advance() {
    offset_ += burst_;
    if (offset_ < options_.bytes) return;
    offset_ = 0;
    ++access_;
    start();
  }

 private:
  void start() {
    const std::uint64_t mask = options_.span_bytes - 1;
    write_ = options_.write;
    switch (options_.pattern) {
      case AccessPattern::sequential:
        base_ = access_ * options_.bytes & mask;
        break;
      case AccessPattern::copy:
        // Read from the lower half, write to the upper one.
        write_ = access_ % 2 == 1;
        base_ =
            (access_ / 2 * options_.bytes & (mask >> 1)) + (write_ ? options_.span_bytes / 2 : 0);
        break;
      case AccessPattern::mixed:
        write_ = (number() & 1) != 0;
        [[fallthrough]];
      case AccessPattern::random:
        base_ = number() & mask & ~std::uint64_t{options_.bytes - 1};
        break;
    }
  }

  /// SplitMix64, from its high bits down.
  std::uint64_t number() {
    std::uint64_t z = random_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  LoadOptions options_;
  std::uint32_t burst_;
  std::uint64_t random_;
  std::uint64_t access_ = 0;
  std::uint64_t base_ = 0;
  std::uint32_t offset_ = 0;
  bool write_ = false;
};

}  // namespace

Result<MemoryMeasurement> measure_memory(Memory& memory, const LoadOptions& options,
                                         const std::function<bool(double)>& progress) {
  const auto refuse = [](const char* what) {
    return Status(StatusCode::invalid_argument, std::string("memory load: ") + what);
  };
  if (!std::has_single_bit(options.bytes)) return refuse("bytes is not a power of two");
  if (!std::has_single_bit(options.span_bytes) || options.span_bytes < 2 * options.bytes) {
    return refuse("span_bytes is not a power of two of at least two accesses");
  }
  if (options.outstanding == 0 || options.accesses == 0 || options.step_ps == 0) {
    return refuse("outstanding, accesses and step_ps are at least 1");
  }

  Load load(options, memory.traits().access_bytes);
  std::uint32_t outstanding = 0;
  Picoseconds now, last;
  std::uint64_t steps = 0;
  while (!load.finished() || !memory.idle()) {
    memory.advance(now);
    for (MemoryCompletion completion; memory.take(completion);) {
      --outstanding;
      last = std::max(last, completion.at);
    }
    while (!load.finished() && outstanding < options.outstanding) {
      const MemoryRequest request = load.next();
      if (!memory.ready(request.address, request.write)) break;
      memory.accept(request, now);
      ++outstanding;
      load.advance();
    }
    // An access without time at all would never let the clock go on.
    now += Picoseconds(options.step_ps);
    if (++steps % 65536 == 0 && progress &&
        !progress(static_cast<double>(load.access()) / static_cast<double>(options.accesses))) {
      return Status(StatusCode::cancelled, "cancelled");
    }
  }
  const MemoryStatistics& statistics = memory.statistics();
  MemoryMeasurement result;
  result.bytes = statistics.read_bytes + statistics.write_bytes;
  // Writes complete before they are carried out: the memory is idle only after them.
  result.time = statistics.writes > 0 ? now : last;
  result.bandwidth_gb_s = result.time.value == 0 ? 0
                                                 : 1000.0 * static_cast<double>(result.bytes) /
                                                       static_cast<double>(result.time.value);
  if (statistics.reads > 0) {
    result.latency_ns = statistics.read_latency_sum_ns / static_cast<double>(statistics.reads);
  }
  return result;
}

}  // namespace fasttree::model
