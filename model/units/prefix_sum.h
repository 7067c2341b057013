// SPDX-License-Identifier: Apache-2.0
// Prefix sum unit (PSU): one section at a time through up-sweep and down-sweep, a section a cycle.
// Docs: docs/accelerator/prefix_sum.md.
#pragma once

#include <cassert>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/unit.h"

namespace fasttree::model {

inline constexpr std::uint32_t kMaxSection = 64;

/// A section to be summed, and the section with its exclusive sums. Copies only what is in use.
struct Section {
  Section() = default;
  explicit Section(std::uint32_t count) : length(count) {}
  Section(const Section& other) { *this = other; }
  Section& operator=(const Section& other) {
    std::memcpy(values, other.values, other.length * sizeof values[0]);
    length = other.length;
    total = other.total;
    tag = other.tag;
    return *this;
  }

  std::uint32_t values[kMaxSection];
  std::uint32_t length = 0;
  std::uint32_t total = 0;  ///< of all values; of a result
  std::uint32_t tag = 0;    ///< the caller's
};

/// First half of Blelloch's scan: a tree of partial sums, each at its right-most leaf.
void up_sweep(std::uint32_t* values, std::uint32_t section);
/// Second half: the sums are handed down the tree. Takes the total out of the last element.
std::uint32_t down_sweep(std::uint32_t* values, std::uint32_t section);

/// Its stages are registers without queues around them: a section that is pushed lies in the first
/// stage in the next cycle, and what lies in the last one is the result. Gaps close, and room that
/// the taker makes is room for the next section in the same cycle: so take before asking ready().
class PrefixSumUnit : public Unit {
 public:
  PrefixSumUnit(std::string name, const PaperConfig::PrefixSum& config);

  bool ready() const { return !pushed_ && (taken_ || held_ < full_.size()); }
  void push(const Section& section);

  bool valid() const { return full_.back() && !taken_; }
  const Section& front() const {
    assert(valid());
    return sections_[first_];
  }
  void drop() {
    assert(valid());
    taken_ = true;
  }

  void tick() override { ticked_ = true; }
  bool done() const override { return held_ == 0 && !pushed_; }
  std::string waits_for() const override;
  /// The rising edge. The account of the cycle is made here, when it is known what was taken.
  void clock();

 private:
  std::size_t slot(std::size_t i) const { return (first_ + i) % sections_.size(); }

  std::uint32_t section_;
  std::vector<bool> full_;         ///< by stage
  std::vector<Section> sections_;  ///< a ring of what the stages hold, summed from the start
  std::size_t first_ = 0;
  std::size_t held_ = 0;  ///< sections in stages
  bool pushed_ = false;   ///< in this cycle
  bool taken_ = false;    ///< in this cycle
  bool ticked_ = false;
};

}  // namespace fasttree::model
