// SPDX-License-Identifier: Apache-2.0
// Internal node generation unit (INGU): the highest bit in which two neighbouring leaves' codes
// differ, by an iterative right shifter. Docs: docs/accelerator/internal_node.md.
#pragma once

#include <cstdint>
#include <string>

#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/system/stream.h"
#include "model/units/split_plane.h"

namespace fasttree::model {

class InternalNodeUnit : public Unit {
 public:
  /// `splits` takes the node on its way to its plane, `marks` its index for the BEU.
  InternalNodeUnit(const PaperConfig& config, BusPort& port, Queue<SplitJob>& splits,
                   Queue<std::uint32_t>& marks);

  void start(Address leaf_codes, std::uint32_t leaves);

  void tick() override;
  bool done() const override { return left_ == 0 && !shifting_; }
  std::string waits_for() const override;

 private:
  bool load();

  PaperConfig config_;
  StreamReader reader_;
  Queue<SplitJob>& splits_;
  Queue<std::uint32_t>& marks_;
  std::uint32_t left_ = 0;  ///< codes to come
  bool first_ = true;
  bool shifting_ = false;
  std::uint32_t code_ = 0;
  std::uint32_t different_ = 0;  ///< in the shifter
  std::int32_t shifts_ = 0;
  std::size_t waits_ = 0;
};

}  // namespace fasttree::model
