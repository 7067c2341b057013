// SPDX-License-Identifier: Apache-2.0
#include "support/large_memory.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <new>
#include <thread>
#include <vector>

namespace fasttree {
namespace {

/// Arrays of all sizes that come and go in any order keep what was written and do not overlap.
RC_GTEST_PROP(LargeMemory, ArraysKeepTheirContent, ()) {
  struct Array {
    std::size_t bytes;
    unsigned char fill;
  };
  std::map<unsigned char*, Array> live;
  const auto check_and_release = [&](std::map<unsigned char*, Array>::iterator at) {
    const auto& [memory, array] = *at;
    RC_ASSERT(std::all_of(memory, memory + array.bytes,
                          [&](unsigned char byte) { return byte == array.fill; }));
    release_large(memory, array.bytes);
    live.erase(at);
  };
  for (int step = 0; step < 24; ++step) {
    if (!live.empty() && *rc::gen::inRange(0, 3) == 0) {
      auto at = live.begin();
      std::advance(at, *rc::gen::inRange<std::size_t>(0, live.size()));
      check_and_release(at);
      continue;
    }
    const std::size_t bytes =
        *rc::gen::element<std::size_t>(1, 64, 2047, 2048, 2049, 70'000, kHugePage / 2 - 1,
                                       kHugePage / 2, kHugePage - 64, kHugePage);
    auto* const memory = static_cast<unsigned char*>(allocate_large(bytes));
    RC_ASSERT(reinterpret_cast<std::uintptr_t>(memory) % 64 == 0);
    const auto fill = static_cast<unsigned char>(step + 1);
    std::memset(memory, fill, bytes);
    live.emplace(memory, Array{bytes, fill});
  }
  while (!live.empty()) check_and_release(live.begin());
}

TEST(LargeMemory, ThreadsMayAllocateAndReleaseEachOthersArrays) {
  constexpr std::size_t kThreads = 4, kArrays = 60;
  std::vector<std::vector<unsigned char*>> made(kThreads);
  const auto bytes = [](std::size_t i) { return 1000 + 977 * i; };
  const auto on_all = [&](const auto& work) {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < kThreads; ++t) threads.emplace_back([&, t] { work(t); });
    for (std::thread& thread : threads) thread.join();
  };
  on_all([&](std::size_t t) {
    for (std::size_t i = 0; i < kArrays; ++i) {
      made[t].push_back(static_cast<unsigned char*>(allocate_large(bytes(i))));
      std::memset(made[t].back(), static_cast<int>(t * 50 + i % 50), bytes(i));
    }
  });
  std::vector<int> wrong(kThreads);
  on_all([&](std::size_t t) {
    const std::size_t other = (t + 1) % kThreads;
    for (std::size_t i = 0; i < kArrays; ++i) {
      unsigned char* const memory = made[other][i];
      for (std::size_t b = 0; b < bytes(i); ++b) wrong[t] += memory[b] != other * 50 + i % 50;
      release_large(memory, bytes(i));
    }
  });
  for (const int count : wrong) EXPECT_EQ(count, 0);
}

TEST(LargeMemory, SaysWhereThereIsNotEnough) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer's own allocator ends the program instead";
#endif
  EXPECT_THROW((void)allocate_large(std::size_t{1} << 60), std::bad_alloc);
}

}  // namespace
}  // namespace fasttree
