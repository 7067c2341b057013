// SPDX-License-Identifier: Apache-2.0
// Behind the MCGUs: takes their pairs in the order of the triangles, counts the digits of the first
// sorting round on the way, and writes them to memory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/system/stream.h"
#include "model/units/morton_code.h"

namespace fasttree::model {

/// A pair as it lies in memory: the code in key_bytes bytes, then the id in four.
inline std::uint32_t pair_bytes(const PaperConfig& config) {
  return config.radix_sort.key_bytes + 4;
}
void pack_pair(const PaperConfig& config, std::uint32_t code, std::uint32_t id, std::uint8_t* to);
void unpack_pair(const PaperConfig& config, const std::uint8_t* from, std::uint32_t& code,
                 std::uint32_t& id);

class PairWriter : public Unit {
 public:
  PairWriter(const PaperConfig& config, BusPort& port);

  void start(Address pairs, std::uint32_t triangles, std::vector<Queue<Pair>*> units);

  void tick() override;
  bool done() const override;
  std::string waits_for() const override;

  std::uint64_t written() const { return written_; }
  const std::vector<std::uint32_t>& digit_counts() const { return counts_; }

 private:
  PaperConfig config_;
  BusPort& port_;
  BlockWriter writer_;
  std::vector<Queue<Pair>*> units_;
  std::size_t unit_ = 0;
  std::uint32_t triangles_left_ = 0;
  std::uint64_t written_ = 0;
  std::vector<std::uint32_t> counts_;
  bool blocked_ = false;
  bool counting_ = false;  ///< the digits of the cycle before
};

}  // namespace fasttree::model
