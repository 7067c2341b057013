// SPDX-License-Identifier: Apache-2.0
#include "model/memory/dram_memory.h"

#include <algorithm>
#include <cassert>

#include "model/memory/statistics.h"

namespace fasttree::model {

DramMemory::DramMemory(const MemoryConfig& config)
    : map_(config.dram, config.controller),
      tck_ps_(config.dram.tck_ps),
      traits_{config.preset, config.dram.channels, config.dram.access_bytes(),
              config.dram.peak_gb_s(),
              std::uint64_t{config.dram.channels} * config.dram.channel_bytes()} {
  statistics_.read_latency_8ns.resize(kLatencyBuckets);
  channels_.reserve(config.dram.channels);
  for (std::uint32_t i = 0; i < config.dram.channels; ++i) {
    channels_.emplace_back(config.dram, config.controller, static_cast<std::uint8_t>(i),
                           statistics_);
  }
}

void DramMemory::accept(const MemoryRequest& request, Picoseconds now) {
  assert(request.bytes > 0);
  assert(request.address.value % traits_.access_bytes + request.bytes <= traits_.access_bytes);
  const DramLocation at = map_.locate(request.address);
  DramChannel& channel = channels_[at.channel];
  channel.advance(now.value / tck_ps_);
  channel.accept(request, at, now);
  record_request(statistics_, request);
  if (request.write) writes_.push({request.tag, true, now});
}

void DramMemory::advance(Picoseconds now) {
  assert(now >= now_);
  now_ = now;
  const std::uint64_t clock = now.value / tck_ps_;
  for (DramChannel& channel : channels_) channel.advance(clock);
}

bool DramMemory::take(MemoryCompletion& completion) {
  CompletionQueue* first = &writes_;
  for (DramChannel& channel : channels_) {
    CompletionQueue& reads = channel.completions();
    if (reads.empty()) continue;
    if (first->empty() || reads.front().at < first->front().at) first = &reads;
  }
  if (first->empty() || first->front().at > now_) return false;
  completion = first->pop();
  return true;
}

bool DramMemory::idle() const {
  if (!writes_.empty()) return false;
  return std::all_of(channels_.begin(), channels_.end(), [](const DramChannel& channel) {
    return channel.idle() && channel.completions().empty();
  });
}

std::string DramMemory::waits_for() const {
  std::string all;
  for (const DramChannel& channel : channels_) {
    const std::string one = channel.waits_for();
    if (!one.empty()) all += (all.empty() ? "" : "; ") + one;
  }
  return all;
}

void DramMemory::observe(CommandObserver* observer) {
  for (DramChannel& channel : channels_) channel.observe(observer);
}

}  // namespace fasttree::model
