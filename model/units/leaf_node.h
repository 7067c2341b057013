// SPDX-License-Identifier: Apache-2.0
// Leaf node generation unit (LNGU): neighbouring codes compared 32 at once, new leaves one by one
// into the buffer pool, sizes as differences of their bases. Docs: docs/accelerator/leaf_node.md.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/unit.h"
#include "model/system/stream.h"

namespace fasttree::model {

class LeafNodeUnit : public Unit {
 public:
  LeafNodeUnit(const PaperConfig& config, BusPort& reads, BusPort& codes, BusPort& rows);

  /// An empty array gives one empty row, the tree of an empty scene, which is not counted.
  void start(Address sorted_codes, std::uint64_t references, Address leaf_codes, Address leaf_rows);

  void tick() override;
  bool done() const override { return finished_; }
  std::string waits_for() const override;

  std::uint32_t leaves() const { return leaves_; }

 private:
  struct Leaf {
    std::uint32_t code = 0;
    std::uint32_t first = 0;
  };
  bool compare();
  bool move();
  bool take_codes();
  bool write_rows();
  bool finish();
  const Leaf& pool(std::size_t i) const { return pool_[(pool_first_ + i) % pool_.size()]; }

  PaperConfig config_;
  BusPort& code_port_;
  BusPort& row_port_;
  StreamReader reader_;
  BlockWriter code_writer_, row_writer_;
  std::uint64_t references_ = 0;
  std::vector<std::uint32_t> codes_;  ///< loaded for the next comparison
  std::uint32_t loaded_bytes_ = 0;
  std::uint64_t base_ = 0;  ///< index of the first code loaded
  std::uint32_t previous_ = 0;
  std::deque<Leaf> found_;  ///< of the last comparison, not in the pool yet
  std::vector<Leaf> pool_;  ///< a ring
  std::size_t pool_first_ = 0;
  std::size_t pool_count_ = 0;
  std::uint32_t leaves_ = 0;
  bool finished_ = true;
  std::size_t waits_ = 0;
};

}  // namespace fasttree::model
