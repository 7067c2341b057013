// SPDX-License-Identifier: Apache-2.0
#include "model/memory/simple_memory.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "model/memory/statistics.h"

namespace fasttree::model {

SimpleMemory::SimpleMemory(const MemoryConfig& config) {
  const bool ideal = config.kind == MemoryKind::ideal;
  traits_ = {config.preset, 1, config.access_bytes, ideal ? 0 : config.bandwidth_gb_s, 0};
  queue_ = ideal ? 0 : config.fixed_queue;
  latency_ps_ = ideal ? 0 : static_cast<std::uint64_t>(std::llround(config.latency_ns * 1000));
  access_ps_ = traits_.peak_gb_s > 0 ? 1000.0 * config.access_bytes / traits_.peak_gb_s : 0;
  statistics_.read_latency_8ns.resize(kLatencyBuckets);
}

bool SimpleMemory::ready(Address, bool) const {
  return queue_ == 0 || under_way_ < queue_;
}

void SimpleMemory::accept(const MemoryRequest& request, Picoseconds now) {
  assert(ready(request.address, request.write));
  assert(request.address.value % traits_.access_bytes + request.bytes <= traits_.access_bytes);
  bus_free_ps_ = std::max(bus_free_ps_, static_cast<double>(now.value)) + access_ps_;
  const Picoseconds at(static_cast<std::uint64_t>(std::ceil(bus_free_ps_)) + latency_ps_);
  completions_.push({request.tag, request.write, at});
  ++under_way_;
  record_request(statistics_, request);
  if (!request.write) record_read_latency(statistics_, at - now);
}

void SimpleMemory::advance(Picoseconds now) {
  assert(now >= now_);
  now_ = now;
}

bool SimpleMemory::take(MemoryCompletion& completion) {
  if (completions_.empty() || completions_.front().at > now_) return false;
  completion = completions_.pop();
  --under_way_;
  return true;
}

std::string SimpleMemory::waits_for() const {
  if (completions_.empty()) return "";
  return "completion at " + std::to_string(completions_.front().at.value) + " ps";
}

}  // namespace fasttree::model
