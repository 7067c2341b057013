// SPDX-License-Identifier: Apache-2.0
// What a unit's write port has brought to memory, and the rules that its requests keep.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "rtl/bench/bench.h"

namespace fasttree::rtl {

class WriteMemory {
 public:
  explicit WriteMemory(std::uint32_t block_bytes) : block_bytes_(block_bytes) {}

  /// The port in a cycle, after settle().
  template <typename Data>
  void look(bool valid, bool ready, std::uint32_t address, std::uint32_t bytes, const Data& data) {
    if (waiting_) {
      EXPECT_TRUE(valid && address == waiting_->address && bytes == waiting_->bytes)
          << "a request changed while it waited";
    }
    waiting_.reset();
    if (!valid) return;
    if (!ready) waiting_ = Request{address, bytes};
    EXPECT_GT(bytes, 0u);
    EXPECT_EQ((address | bytes) % 4, 0u);
    EXPECT_EQ(address / block_bytes_, (address + bytes - 1) / block_bytes_) << "two blocks";
    if (!ready) return;
    ++requests_;
    for (std::uint32_t at = address; at < address + bytes; at += 4) {
      const std::uint32_t word = get_word(data, at % block_bytes_ / 4);
      EXPECT_TRUE(words_.emplace(at, word).second) << at << " is written twice";
    }
  }

  /// All words, which are to be one run from an address; the list ends where there is none.
  std::vector<std::uint32_t> run_from(std::uint32_t address) const {
    std::vector<std::uint32_t> list;
    for (const auto& [at, word] : words_) {
      if (at != address + 4 * list.size()) {
        ADD_FAILURE() << at << " is outside of the run";
        break;
      }
      list.push_back(word);
    }
    return list;
  }
  std::size_t requests() const { return requests_; }

 private:
  struct Request {
    std::uint32_t address, bytes;
  };
  std::uint32_t block_bytes_;
  std::map<std::uint32_t, std::uint32_t> words_;
  std::optional<Request> waiting_;
  std::size_t requests_ = 0;
};

}  // namespace fasttree::rtl
