// SPDX-License-Identifier: Apache-2.0
// The stream that a build answers with: a header, the stages' counters, the tree's nodes, its ids.
// Layout by byte: docs/protocol.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "device/link/byte_source.h"
#include "device/order.h"
#include "fasttree/status.h"

namespace fasttree::device {

inline constexpr std::size_t kResultHeaderBytes = 128;
inline constexpr std::size_t kStageBytes = 64;
inline constexpr std::size_t kMostStages = 64;

/// The outcome as a stream. Holds the outcome; nodes and ids are not copied.
class ResultSource : public ByteSource {
 public:
  explicit ResultSource(Outcome outcome);
  ResultSource(const ResultSource&) = delete;
  ResultSource& operator=(const ResultSource&) = delete;
  std::uint64_t size() const override { return parts_.size(); }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    parts_.read(offset, out);
  }

 private:
  Outcome outcome_;
  std::vector<std::byte> head_;
  PartsSource parts_;
};

/// The outcome that a stream says. The tree views `bytes`, which `owner` keeps, 8-aligned.
/// bad_input: sizes that do not agree, a value that cannot be, another tree than its hash says. The
/// tree's links are a matter for verify().
Result<Outcome> parse_result(std::span<const std::byte> bytes, std::shared_ptr<const void> owner);

}  // namespace fasttree::device
