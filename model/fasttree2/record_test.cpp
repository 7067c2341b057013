// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/record.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

namespace fasttree::model::ft2 {
namespace {

RC_GTEST_PROP(RecordFormat, GivesBackWhatWasPackedAndTouchesNoOtherByte, ()) {
  const auto triangles = *rc::gen::inRange<std::uint32_t>(1, kMaxTriangles);
  std::array<std::uint8_t, 3> bits{};
  int left = 30;
  for (auto& b : bits) {
    b = static_cast<std::uint8_t>(*rc::gen::inRange(0, std::min(left, 15) + 1));
    left -= b;
  }
  const RecordFormat format(triangles, bits);
  Record record;
  record.id = *rc::gen::inRange<std::uint32_t>(0, triangles);
  for (std::size_t a = 0; a < 3; ++a) {
    record.box.lo[a] = *rc::gen::inRange<std::uint32_t>(0, 1u << bits[a]);
    record.box.hi[a] = *rc::gen::inRange<std::uint32_t>(0, 1u << bits[a]);
  }
  std::vector<std::uint8_t> bytes(format.bytes() + 2, 0xa5);
  format.pack(record, bytes.data() + 1);
  RC_ASSERT(bytes.front() == 0xa5);
  RC_ASSERT(bytes.back() == 0xa5);
  const Record back = format.unpack(bytes.data() + 1);
  RC_ASSERT(back.id == record.id);
  RC_ASSERT(back.box.lo == record.box.lo);
  RC_ASSERT(back.box.hi == record.box.hi);
}

TEST(RecordFormat, IsAsNarrowAsTheSceneAllows) {
  // Bunny: 17 bits of id, D = 18, 512 buckets, so three bits an axis and corner.
  EXPECT_EQ(RecordFormat(69'451, {3, 3, 3}).bytes(), 5u);
  EXPECT_EQ(RecordFormat(871'414, {4, 4, 4}).bytes(), 6u);
  EXPECT_EQ(RecordFormat(kMaxTriangles, {10, 10, 10}).bytes(), 12u);
}

TEST(ChunkFormat, LosesFourBytesOfTheFirstLineToTheLink) {
  const ChunkFormat format{256, 64, 6};
  EXPECT_EQ(format.lines(), 4u);
  EXPECT_EQ(format.records(0), 10u);
  EXPECT_EQ(format.records(1), 10u);
  const ChunkFormat tight{256, 64, 8};
  EXPECT_EQ(tight.records(0), 7u);
  EXPECT_EQ(tight.records(3), 8u);
  EXPECT_EQ(tight.records_of_chunk(), 7u + 3 * 8u);
}

}  // namespace
}  // namespace fasttree::model::ft2
