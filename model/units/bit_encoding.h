// SPDX-License-Identifier: Apache-2.0
// Bit encoding unit (BEU): clears the marks, then gathers the marks of 32 neighbouring nodes into a
// word and writes it through the cache. Docs: docs/accelerator/bit_encoding.md.
#pragma once

#include <cstdint>
#include <string>

#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/system/stream.h"
#include "model/units/mark_cache.h"

namespace fasttree::model {

class BitEncodingUnit : public Unit {
 public:
  BitEncodingUnit(const PaperConfig& config, BusPort& port, Queue<MarkRequest>& cache);

  Queue<std::uint32_t> input;  ///< node indices, ascending

  void start_clear(Address marks, std::uint64_t bytes);
  void start_marks(Address marks, std::uint32_t nodes);

  void tick() override;
  bool done() const override;
  std::string waits_for() const override;
  void clock() { input.clock(); }

 private:
  bool clear();
  bool mark();

  BusPort& port_;
  Queue<MarkRequest>& cache_;
  std::uint64_t marks_ = 0;
  std::uint64_t clear_next_ = 0;
  std::uint64_t clear_end_ = 0;
  std::uint32_t left_ = 0;
  bool holds_ = false;  ///< a word with marks
  std::uint32_t word_index_ = 0;
  std::uint32_t word_ = 0;
  std::size_t waits_ = 0;
};

}  // namespace fasttree::model
