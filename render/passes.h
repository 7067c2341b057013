// SPDX-License-Identifier: Apache-2.0
// A picture is drawn in passes over its tiles, each pass in parallel, with progress and cancel.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>

#include "fasttree/build.h"
#include "fasttree/trace.h"

namespace fasttree::render {

inline double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// Adds up what threads count, and asks the callback, one thread at a time.
class Work {
 public:
  Work(const ProgressCallback& progress, std::uint64_t total)
      : progress_(progress), total_(std::max<std::uint64_t>(total, 1)) {}

  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  /// `amount` of the total is done. Where another thread is in the callback, it is not waited for.
  void done(const char* stage, std::uint64_t amount) {
    const std::uint64_t sum = done_.fetch_add(amount, std::memory_order_relaxed) + amount;
    if (!progress_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock() || cancelled()) return;
    // Sums can arrive out of order; a person wants to see them grow.
    reported_ = std::max(reported_, sum);
    const double fraction = static_cast<double>(reported_) / static_cast<double>(total_);
    if (!progress_(stage, std::min(fraction, 1.0))) cancelled_ = true;
  }

 private:
  const ProgressCallback& progress_;
  std::uint64_t total_;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::mutex mutex_;
  std::uint64_t reported_ = 0;
};

/// Sums of a pass over its tiles. Whole numbers, so that the order does not matter.
class PassCounters {
 public:
  void add(std::uint64_t rays, const TraceCounters& c) {
    rays_ += rays;
    inner_steps_ += c.inner_steps;
    leaf_visits_ += c.leaf_visits;
    triangle_tests_ += c.triangle_tests;
  }
  std::uint64_t rays() const { return rays_; }
  TraceCounters counters() const { return {inner_steps_, leaf_visits_, triangle_tests_}; }

 private:
  std::atomic<std::uint64_t> rays_{0}, inner_steps_{0}, leaf_visits_{0}, triangle_tests_{0};
};

struct Tile {
  std::uint32_t x0, y0, x1, y1;
};

inline constexpr std::uint32_t kTileSize = 16;

inline std::uint64_t tile_count(std::uint32_t width, std::uint32_t height) {
  return std::uint64_t{(width + kTileSize - 1) / kTileSize} *
         ((height + kTileSize - 1) / kTileSize);
}

/// Runs body(tile) for all tiles, on the threads of the calling arena. Each tile is one unit of
/// work. False: cancelled, with some tiles left out.
template <typename Body>
bool for_tiles(std::uint32_t width, std::uint32_t height, Work& work, const char* stage,
               const Body& body) {
  const std::uint64_t columns = (width + kTileSize - 1) / kTileSize;
  tbb::parallel_for(std::uint64_t{0}, tile_count(width, height), [&](std::uint64_t i) {
    if (work.cancelled()) return;
    Tile tile;
    tile.x0 = static_cast<std::uint32_t>(i % columns) * kTileSize;
    tile.y0 = static_cast<std::uint32_t>(i / columns) * kTileSize;
    tile.x1 = std::min(tile.x0 + kTileSize, width);
    tile.y1 = std::min(tile.y0 + kTileSize, height);
    body(tile);
    work.done(stage, 1);
  });
  return !work.cancelled();
}

}  // namespace fasttree::render
