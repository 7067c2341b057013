// SPDX-License-Identifier: Apache-2.0
#include "model/kernel/queue.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <deque>
#include <vector>

#include "model/kernel/unit.h"

namespace fasttree::model {
namespace {

TEST(Queue, ShowsAPushInTheNextCycleAndRoomInTheNextCycle) {
  Queue<int> queue(1);
  EXPECT_TRUE(queue.ready());
  queue.push(7);
  EXPECT_FALSE(queue.valid());
  EXPECT_FALSE(queue.ready());
  queue.clock();
  ASSERT_TRUE(queue.valid());
  EXPECT_EQ(queue.pop(), 7);
  EXPECT_FALSE(queue.ready()) << "room made in this cycle is for the next one";
  queue.clock();
  EXPECT_TRUE(queue.ready());
  EXPECT_TRUE(queue.empty());
}

/// Producer and consumer do the same whichever comes first in a cycle, and nothing is lost.
RC_GTEST_PROP(Queue, IsTheSameInEitherOrderOfItsUnits, ()) {
  const auto depth = *rc::gen::inRange<std::size_t>(1, 6);
  const auto pushes = *rc::gen::container<std::vector<bool>>(200, rc::gen::arbitrary<bool>());
  const auto pops = *rc::gen::container<std::vector<bool>>(200, rc::gen::arbitrary<bool>());
  Queue<int> first(depth);
  Queue<int> second(depth);
  std::vector<int> from_first;
  std::vector<int> from_second;
  int next_first = 0;
  int next_second = 0;
  for (std::size_t cycle = 0; cycle < pushes.size(); ++cycle) {
    if (pushes[cycle] && first.ready()) first.push(next_first++);
    if (pops[cycle] && first.valid()) from_first.push_back(first.pop());
    if (pops[cycle] && second.valid()) from_second.push_back(second.pop());
    if (pushes[cycle] && second.ready()) second.push(next_second++);
    first.clock();
    second.clock();
  }
  RC_ASSERT(from_first == from_second);
  RC_ASSERT(next_first == next_second);
  for (std::size_t i = 0; i < from_first.size(); ++i) {
    RC_ASSERT(from_first[i] == static_cast<int>(i));
  }
}

}  // namespace
}  // namespace fasttree::model
