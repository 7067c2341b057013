// SPDX-License-Identifier: Apache-2.0
// A memory alone under a simple load: what bandwidth and latency it gives.
#pragma once

#include <cstdint>
#include <functional>

#include "fasttree/status.h"
#include "model/memory/memory.h"

namespace fasttree::model {

enum class AccessPattern : std::uint8_t {
  sequential,  ///< one stream
  random,      ///< aligned accesses anywhere
  copy,        ///< a stream read and a stream written, access by access
  mixed,       ///< random accesses, each a read or a write by the toss of a coin
};

struct LoadOptions {
  AccessPattern pattern = AccessPattern::sequential;
  bool write = false;              ///< sequential and random
  std::uint32_t bytes = 64;        ///< of an access, a power of two; it takes a request a burst
  std::uint32_t outstanding = 64;  ///< requests accepted and not completed, at most
  std::uint64_t accesses = 100000;
  std::uint64_t span_bytes = std::uint64_t{256} << 20;  ///< addresses from 0; a power of two
  std::uint64_t step_ps = 1250;  ///< how often the load looks whether it can ask for more
  std::uint64_t seed = 1;
};

struct MemoryMeasurement {
  double bandwidth_gb_s = 0;  ///< 10^9 bytes a second, to the last byte's end
  double latency_ns = 0;      ///< of a read on average, from acceptance to data; 0 without reads
  std::uint64_t bytes = 0;
  Picoseconds time;
};

/// Requests go out in order, as many as the memory takes; the first that it does not take holds up
/// those after it. `memory` is new. `progress`, where given, ends the run by false.
Result<MemoryMeasurement> measure_memory(Memory& memory, const LoadOptions& options,
                                         const std::function<bool(double)>& progress = {});

}  // namespace fasttree::model
