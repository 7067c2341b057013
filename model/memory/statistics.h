// SPDX-License-Identifier: Apache-2.0
// How the implementations of Memory keep its statistics.
#pragma once

#include <algorithm>
#include <cstddef>

#include "model/memory/memory.h"

namespace fasttree::model {

inline constexpr std::size_t kLatencyBuckets = 64;

inline void record_read_latency(MemoryStatistics& statistics, Picoseconds latency) {
  const std::size_t bucket = static_cast<std::size_t>(latency.value / 8000);
  ++statistics.read_latency_8ns[std::min(bucket, kLatencyBuckets - 1)];
  statistics.read_latency_sum_ns += static_cast<double>(latency.value) / 1000.0;
}

inline void record_request(MemoryStatistics& statistics, const MemoryRequest& request) {
  ++(request.write ? statistics.writes : statistics.reads);
  (request.write ? statistics.write_bytes : statistics.read_bytes) += request.bytes;
}

}  // namespace fasttree::model
