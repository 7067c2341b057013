// SPDX-License-Identifier: Apache-2.0
// What bytes crossed the AXI bus for: told by the address and the stage, in the model's words.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/report/simulation.h"
#include "model/system/bus.h"
#include "model/system/memory_map.h"
#include "rtl/bench/axi_memory.h"

namespace fasttree::rtl {

class TrafficAccount : public AxiObserver {
 public:
  explicit TrafficAccount(const model::MemoryMap& map) : map_(map) {}

  void burst(std::uint32_t address, std::uint32_t bytes, bool write, std::uint32_t id) override {
    // AXI reads whole beats: of one, the cache wants a block.
    if (!write && id == kCacheId) bytes = kCacheBlock;
    const auto purpose = static_cast<std::size_t>(purpose_of(address, bytes));
    (write ? write_bytes_ : read_bytes_)[purpose] += bytes;
    moved_bytes_ += bytes;
  }

  std::uint64_t moved_bytes() const { return moved_bytes_; }

  /// Since the last call.
  std::vector<model::Traffic> take() {
    std::vector<model::Traffic> traffic;
    for (std::size_t i = 0; i < model::kPurposes; ++i) {
      if (read_bytes_[i] == 0 && write_bytes_[i] == 0) continue;
      traffic.push_back(
          {to_string(static_cast<model::Purpose>(i)), read_bytes_[i], write_bytes_[i]});
    }
    read_bytes_ = write_bytes_ = {};
    return traffic;
  }

 private:
  // Regions follow each other in the order of the map. Two have two uses: zeros over the marks come
  // in blocks, marks by the eight bytes of the cache; nodes in blocks, links by four bytes.
  model::Purpose purpose_of(std::uint64_t at, std::uint32_t bytes) const {
    using model::Purpose;
    if (at >= map_.nodes.value) return bytes > 4 ? Purpose::nodes : Purpose::links;
    if (at >= map_.marks.value) return bytes > 8 ? Purpose::clear : Purpose::marks;
    if (at >= map_.leaf_rows.value) return Purpose::leaf_rows;
    if (at >= map_.leaf_codes.value) return Purpose::leaf_codes;
    if (at >= map_.sorted_ids.value) return Purpose::sorted_ids;
    if (at >= map_.sorted_codes.value) return Purpose::sorted_codes;
    if (at >= map_.pairs[0].value) return Purpose::pairs;
    return Purpose::scene;
  }

  static constexpr std::uint32_t kCacheId = 1;
  static constexpr std::uint32_t kCacheBlock = 8;

  model::MemoryMap map_;
  std::uint64_t moved_bytes_ = 0;
  std::array<std::uint64_t, model::kPurposes> read_bytes_{};
  std::array<std::uint64_t, model::kPurposes> write_bytes_{};
};

}  // namespace fasttree::rtl
