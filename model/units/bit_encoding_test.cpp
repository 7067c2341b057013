// SPDX-License-Identifier: Apache-2.0
#include "model/units/bit_encoding.h"

#include <gtest/gtest.h>

#include <set>

#include "model/units/unit_bench.h"
#include "reference/bit_encoding.h"
#include "tests/support/meshes.h"

namespace fasttree::model {
namespace {

TEST(BitEncodingUnit, WritesEachWordOnce) {
  fasttree::test::Random random(2);
  std::set<std::uint32_t> marked;
  for (int i = 0; i < 700; ++i) marked.insert(random.below(1u << 14));
  reference::InternalNodes nodes;
  nodes.node_index.assign(marked.begin(), marked.end());
  const reference::EssentialBitmap expected = reference::bit_encoding(nodes, 13);

  const Address marks(4096);
  test::UnitBench bench;
  bench.put(marks, std::vector<std::uint32_t>(512, 0xa5a5a5a5));
  Queue<MarkRequest> cache(2);
  BitEncodingUnit unit(bench.config, bench.bus.add_port("clear"), cache);
  unit.start_clear(marks, 512 * 4);
  bench.run({&unit});
  std::vector<std::uint32_t> words = bench.words(marks, 512);
  EXPECT_EQ(words, std::vector<std::uint32_t>(512, 0)) << "cleared";

  unit.start_marks(marks, static_cast<std::uint32_t>(marked.size()));
  Clocks clocks;
  clocks.add(unit);
  clocks.add(cache);
  std::set<std::uint64_t> written;
  for (auto next = marked.begin(); !unit.done() || !cache.empty();) {
    if (next != marked.end() && unit.input.ready()) unit.input.push(*next++);
    if (cache.valid()) {
      const MarkRequest request = cache.pop();
      EXPECT_TRUE(request.write);
      EXPECT_TRUE(written.insert(request.address.value).second) << "once";
      words[(request.address.value - marks.value) / 4] = request.word;
    }
    bench.step({&unit}, clocks);
  }
  EXPECT_EQ(words, expected.words());
}

}  // namespace
}  // namespace fasttree::model
