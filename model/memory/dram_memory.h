// SPDX-License-Identifier: Apache-2.0
// DRAM behind the interface of a memory: an address map over channels, each with its controller.
#pragma once

#include <vector>

#include "model/memory/address_map.h"
#include "model/memory/channel.h"
#include "model/memory/memory.h"
#include "model/memory/memory_config.h"

namespace fasttree::model {

/// A write completes when it is accepted: from then on the controller keeps later requests to its
/// bytes behind it. A request may be served from the next clock of the memory on.
class DramMemory final : public Memory {
 public:
  /// `config` has passed validate().
  explicit DramMemory(const MemoryConfig& config);
  DramMemory(const DramMemory&) = delete;  // the channels point into it
  DramMemory& operator=(const DramMemory&) = delete;

  const MemoryTraits& traits() const override { return traits_; }
  bool ready(Address address, bool write) const override {
    return channels_[map_.channel(address)].ready(write);
  }
  void accept(const MemoryRequest& request, Picoseconds now) override;
  void advance(Picoseconds now) override;
  bool take(MemoryCompletion& completion) override;
  bool idle() const override;
  const MemoryStatistics& statistics() const override { return statistics_; }
  std::string waits_for() const override;

  /// Shows every command from now on to `observer`, which outlives the memory; null: to nobody.
  void observe(CommandObserver* observer);

 private:
  AddressMap map_;
  std::uint32_t tck_ps_;
  MemoryTraits traits_;
  MemoryStatistics statistics_;
  std::vector<DramChannel> channels_;
  CompletionQueue writes_;
  Picoseconds now_;
};

}  // namespace fasttree::model
