// SPDX-License-Identifier: Apache-2.0
// Prefix sum unit (PSU): one section at a time through up-sweep and down-sweep, a section a cycle.
// Docs: docs/accelerator/prefix_sum.md.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
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

class PrefixSumUnit : public Unit {
 public:
  PrefixSumUnit(std::string name, const PaperConfig::PrefixSum& config);

  Queue<Section> input;
  Queue<Section> output;

  void tick() override;
  bool done() const override;
  std::string waits_for() const override;
  void clock() {
    input.clock();
    output.clock();
  }

 private:
  struct Stage {
    bool full = false;
    Section section;
  };

  std::uint32_t section_;
  std::uint32_t held_ = 0;     ///< sections in the stages
  std::vector<Stage> stages_;  ///< up-sweep in the first half, down-sweep in the second
};

}  // namespace fasttree::model
