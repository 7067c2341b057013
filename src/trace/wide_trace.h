// SPDX-License-Identifier: Apache-2.0
// Rays through the wide layout, with the widest vectors of the processor: in batches, two rays at a
// time, and in packets of 64. The same results as testing every triangle, to the bit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fasttree/trace.h"
#include "trace/wide_layout.h"

namespace fasttree {

/// What the kernels need of a scene.
struct WideScene {
  const WideLayout* layout = nullptr;
  Box3 bounds;
};

/// Rays of a packet.
inline constexpr std::size_t kPacket = 64;

/// Traces rays one by one. Those that are not tame (WideRay) are left alone, and appended to
/// `wild`. Exactly one of `hits` and `flags` is used; `counters` may be null.
struct WideBatch {
  std::span<const Ray> rays;
  std::span<Hit> hits;
  std::span<std::uint8_t> flags;
  TraceCounters* counters = nullptr;
  std::vector<std::uint32_t>* wild = nullptr;
};

/// Appends all rays to `wild`.
void leave_all(const WideBatch& batch);

void wide_closest(const WideScene& scene, const WideBatch& batch);
void wide_occluded(const WideScene& scene, const WideBatch& batch);

/// The same for coherent rays, in packets of kPacket neighbours.
void packet_closest(const WideScene& scene, const WideBatch& batch);
void packet_occluded(const WideScene& scene, const WideBatch& batch);

}  // namespace fasttree
