// SPDX-License-Identifier: Apache-2.0
// Off-chip memory as the accelerator sees it: requests in, completions out, each at its time. It
// knows time only; the bytes are in a ByteStore (byte_store.h) beside it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/kernel/quantities.h"

namespace fasttree::model {

/// One access, inside one aligned granule of Memory::traits().access_bytes.
struct MemoryRequest {
  Address address;
  std::uint32_t bytes = 0;
  bool write = false;
  std::uint32_t tag = 0;  ///< the caller's, given back with the completion
};

/// The data of a read has arrived, or a write can no longer be overtaken by a later request to the
/// same bytes.
struct MemoryCompletion {
  std::uint32_t tag = 0;
  bool write = false;
  Picoseconds at;
};

struct MemoryTraits {
  std::string name;
  std::uint32_t channels = 1;
  std::uint32_t access_bytes = 32;   ///< what one burst moves; requests do not cross such granules
  double peak_gb_s = 0;              ///< 10^9 bytes a second; 0: unlimited
  std::uint64_t capacity_bytes = 0;  ///< from address 0; 0: whatever is asked for
};

struct MemoryStatistics {
  std::uint64_t read_bytes = 0;  ///< asked for; a short access still takes a whole burst
  std::uint64_t write_bytes = 0;
  std::uint64_t reads = 0;
  std::uint64_t writes = 0;
  std::uint64_t row_hits = 0;       ///< accesses that found their row open
  std::uint64_t row_misses = 0;     ///< bank closed: one activate
  std::uint64_t row_conflicts = 0;  ///< another row open: precharge, then activate
  std::uint64_t refreshes = 0;
  std::uint64_t turnarounds = 0;  ///< changes between reading and writing
  /// Reads by latency, from acceptance to data: bucket i holds [8 i, 8 (i + 1)) ns, the last one
  /// everything longer.
  std::vector<std::uint64_t> read_latency_8ns;
  double read_latency_sum_ns = 0;
};

/// Any memory. Time never goes back. Two accesses that touch the same bytes, of which one writes,
/// take effect in the order they were accepted.
class Memory {
 public:
  virtual ~Memory() = default;

  virtual const MemoryTraits& traits() const = 0;

  /// Whether a request to this address can be accepted now (its channel's queue has room).
  virtual bool ready(Address address, bool write) const = 0;
  /// Only where ready(). `now` is not before the last advance().
  virtual void accept(const MemoryRequest& request, Picoseconds now) = 0;

  /// Carries out everything up to and including `now`.
  virtual void advance(Picoseconds now) = 0;

  /// The next completion with `at` not after the last advance(), in order of time; false: none.
  virtual bool take(MemoryCompletion& completion) = 0;

  /// Nothing queued, nothing under way, nothing to take.
  virtual bool idle() const = 0;

  virtual const MemoryStatistics& statistics() const = 0;

  /// What the oldest request waits for, for the report of a machine that is stuck.
  virtual std::string waits_for() const = 0;
};

}  // namespace fasttree::model
