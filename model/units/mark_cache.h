// SPDX-License-Identifier: Apache-2.0
// The on-chip cache between BEU and PCU: set associative, least recently used, write back, one
// request at a time. Docs: docs/accelerator/mark_cache.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/report/simulation.h"
#include "model/system/bus.h"

namespace fasttree::model {

/// A word of marks, read or written.
struct MarkRequest {
  Address address;
  bool write = false;
  std::uint32_t word = 0;
};

class MarkCache : public Unit {
 public:
  MarkCache(const PaperConfig& config, BusPort& port);

  Queue<MarkRequest> requests;
  Queue<std::uint32_t> answers;  ///< to reads

  void tick() override;
  bool done() const override;
  std::string waits_for() const override;
  void clock() {
    requests.clock();
    answers.clock();
  }

  const CacheStatistics& statistics() const { return statistics_; }

  /// Writes what memory does not have yet into a copy of it; takes no cycles. For looking at marks
  /// after a run.
  void copy_dirty(Address base, std::vector<std::uint8_t>& bytes) const;

  /// For tests: evicts the block used last instead of the one used least recently.
  void break_replacement() { broken_replacement_ = true; }

 private:
  enum class State { ready, hit, miss, write_back, fetch, refill, write_through };
  struct Block {
    bool valid = false;
    bool dirty = false;
    std::uint64_t number = 0;  ///< address over block size
    std::uint64_t used = 0;    ///< when, in requests
  };
  void look_up();
  Block* find(std::uint64_t number);
  Block* victim(std::uint64_t number);
  std::uint8_t* data(const Block* block);
  bool write_back();
  bool fetch();
  void finish();

  PaperConfig::MarkCache config_;
  BusPort& port_;
  std::uint32_t sets_;
  std::vector<Block> blocks_;       ///< set by set
  std::vector<std::uint8_t> data_;  ///< as blocks_
  State state_ = State::ready;
  MarkRequest request_;
  Block* block_ = nullptr;
  std::uint32_t wait_ = 0;
  bool asked_ = false;
  std::uint64_t uses_ = 0;
  bool broken_replacement_ = false;
  CacheStatistics statistics_;
};

}  // namespace fasttree::model
