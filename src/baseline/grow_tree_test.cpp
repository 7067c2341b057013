// SPDX-License-Identifier: Apache-2.0
// The shared loop, driven by splitters that real scenes would not have.
#include "baseline/grow_tree.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <new>
#include <optional>
#include <vector>

#include "baseline/test_meshes.h"

namespace fasttree::baseline {
namespace {

/// Halves every cell on its longest axis and says that both halves have all triangles.
class ExplodingSplitter {
 public:
  ExplodingSplitter(const BaselineInput& input, MemoryBudget&) : input_(input) {}

  Status prepare() { return {}; }

  std::optional<Split> best_split(const OpenCell& cell) const {
    std::uint32_t axis = 0;
    for (std::uint32_t a = 1; a < 3; ++a) {
      if (cell.box.extent()[a] > cell.box.extent()[axis]) axis = a;
    }
    const float middle = (cell.box.lo[axis] + cell.box.hi[axis]) / 2;
    return Split{axis, middle, false, cell.count, cell.count, 0.0};
  }

  Status partition(const OpenCell&, Split&) { return {}; }

  void take(std::vector<std::uint32_t>& ids) {
    for (std::uint32_t t = 0; t < input_.mesh.triangle_count; ++t) ids.push_back(t);
  }

 private:
  const BaselineInput& input_;
};

/// Runs out of memory.
class FailingSplitter : public ExplodingSplitter {
 public:
  using ExplodingSplitter::ExplodingSplitter;
  Status prepare() { throw std::bad_alloc(); }
};

template <typename Splitter>
Result<Tree> build_by(const testing::Soup& soup) {
  const MeshView mesh = soup.view();
  const ProgressCallback none;
  const BaselineInput input{mesh, soup.bounds(), {}, 0, none};
  return build_with<Splitter>(input, Profile::sah_exact, "sah_exact");
}

TEST(GrowTree, ReferencesAreBounded) {
  const testing::Soup soup = testing::random_soup(1'000, 0.1f, 1);
  const Result<Tree> result = build_by<ExplodingSplitter>(soup);
  ASSERT_TRUE(result.ok());
  check_structure(result.value(), soup, testing::Which::exact);
  // As many leaves as fit under the bound: 36'096 references.
  EXPECT_EQ(result.value().leaf_count(), 36u);
}

TEST(GrowTree, DepthIsBounded) {
  const testing::Soup soup = testing::random_soup(2, 0.1f, 1);
  const Result<Tree> result = build_by<ExplodingSplitter>(soup);
  ASSERT_TRUE(result.ok());
  check_structure(result.value(), soup, testing::Which::exact);
  EXPECT_EQ(result.value().leaf_count(), 1u << depth_bound(2));
}

TEST(GrowTree, FailedAllocationIsAStatus) {
  const Result<Tree> result = build_by<FailingSplitter>(testing::random_soup(10, 0.1f, 1));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.status().code(), StatusCode::resource_limit);
  EXPECT_FALSE(result.status().message().empty());
}

TEST(DepthBound, GrowsWithTheLogarithmAndEnds) {
  EXPECT_EQ(depth_bound(0), 8u);
  EXPECT_EQ(depth_bound(1), 8u);
  EXPECT_EQ(depth_bound(2), 9u);
  EXPECT_EQ(depth_bound(1024), 21u);
  EXPECT_EQ(depth_bound(1'000'000), 34u);
  EXPECT_EQ(depth_bound(kMaxTriangles), 47u);
}

TEST(ReferenceBound, FitsTheNodesIndex) {
  EXPECT_EQ(reference_bound(0), 4096u);
  EXPECT_EQ(reference_bound(1'000), 36'096u);
  EXPECT_EQ(reference_bound(kMaxTriangles), 0xffffffffu);
}

}  // namespace
}  // namespace fasttree::baseline
