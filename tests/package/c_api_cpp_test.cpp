// SPDX-License-Identifier: Apache-2.0
// What of the C interface only C++ and threads can see: equality with the C++ interface, exceptions
// out of callbacks, the error text of each thread.
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "fasttree/build.h"
#include "fasttree/fasttree_c.h"
#include "tree/test_trees.h"

namespace fasttree {
namespace {

struct Free {
  void operator()(ft_builder* b) const { ft_builder_free(b); }
  void operator()(ft_tree* t) const { ft_tree_free(t); }
};

class CApi : public testing::Test {
 protected:
  CApi() {
    test::Rng rng(1);
    mesh_ = test::random_mesh(rng, 100);
    view_.positions = mesh_.corners.data();
    view_.vertex_count = static_cast<std::uint32_t>(mesh_.corners.size());
    view_.triangle_count = mesh_.triangle_count();
    ft_builder* builder = nullptr;
    EXPECT_EQ(ft_builder_create(&builder), FT_OK);
    builder_.reset(builder);
  }

  ft_status build(const ft_build_settings& settings) {
    ft_tree* tree = nullptr;
    const ft_status status = ft_builder_build(builder_.get(), &view_, &settings, &tree);
    tree_.reset(tree);
    return status;
  }

  test::Mesh mesh_;
  ft_mesh view_ = FT_MESH_INIT;
  std::unique_ptr<ft_builder, Free> builder_;
  std::unique_ptr<ft_tree, Free> tree_;
};

TEST_F(CApi, BuildsTheSameTreesAsCpp) {
  for (std::uint32_t profile = 0; profile < 4; ++profile) {
    for (std::uint32_t axes = 0; axes < 2; ++axes) {
      ft_build_settings settings = FT_BUILD_SETTINGS_INIT;
      settings.profile = profile;
      settings.axes = axes;
      settings.extra_depth = 2;
      settings.max_growth = 10;
      ASSERT_EQ(build(settings), FT_OK) << ft_last_error();
      std::uint64_t hash = 0;
      ASSERT_EQ(ft_tree_get_hash(tree_.get(), &hash), FT_OK);
      BuildSettings same;
      same.profile = static_cast<Profile>(profile);
      same.axes = static_cast<AxisSchedule>(axes);
      same.extra_depth = 2;
      same.max_growth = 10;
      EXPECT_EQ(hash, Builder().build(mesh_.view(), same).value().hash());
    }
  }
}

TEST_F(CApi, InitialValuesAreTheDefaultsOfCpp) {
  const ft_build_settings c = FT_BUILD_SETTINGS_INIT;
  const BuildSettings cpp;
  EXPECT_EQ(c.profile, static_cast<std::uint32_t>(cpp.profile));
  EXPECT_EQ(c.axes, static_cast<std::uint32_t>(cpp.axes));
  EXPECT_EQ(c.depth, cpp.depth);
  EXPECT_EQ(c.extra_depth, cpp.extra_depth);
  EXPECT_EQ(c.max_growth, cpp.max_growth);
  EXPECT_EQ(c.memory_limit_bytes, cpp.memory_limit_bytes);
  EXPECT_EQ(c.sah_traversal_cost, cpp.sah_costs.traversal);
  EXPECT_EQ(c.sah_intersection_cost, cpp.sah_costs.intersection);
  EXPECT_EQ(c.implementation, static_cast<std::uint32_t>(cpp.implementation));
  EXPECT_EQ(c.simd, static_cast<std::uint32_t>(cpp.simd));
}

template <typename Exception>
int throwing(void*, const char*, double) {
  throw Exception("from the callback");
}

struct Odd {
  explicit Odd(const char*) {}
};

struct NoMemory : std::bad_alloc {
  explicit NoMemory(const char*) {}
};

TEST_F(CApi, LetsNoExceptionOut) {
  ft_build_settings settings = FT_BUILD_SETTINGS_INIT;
  const struct {
    ft_progress_fn callback;
    ft_status status;
    const char* message;
  } cases[] = {
      {throwing<std::runtime_error>, FT_CANCELLED, "from the callback"},
      {throwing<Odd>, FT_CANCELLED, "callback"},
      {throwing<NoMemory>, FT_RESOURCE_LIMIT, "memory"},
      {throwing<std::length_error>, FT_RESOURCE_LIMIT, "memory"},
  };
  for (const auto& c : cases) {
    settings.progress = c.callback;
    EXPECT_EQ(build(settings), c.status);
    EXPECT_NE(std::string(ft_last_error()).find(c.message), std::string::npos) << ft_last_error();
    EXPECT_EQ(tree_, nullptr);
  }
  // The builder and a tree built into stay usable.
  settings.progress = nullptr;
  ASSERT_EQ(build(settings), FT_OK);
  std::uint64_t before = 0;
  std::uint64_t after = 0;
  ASSERT_EQ(ft_tree_get_hash(tree_.get(), &before), FT_OK);
  settings.progress = throwing<std::runtime_error>;
  EXPECT_EQ(ft_builder_build_into(builder_.get(), &view_, &settings, tree_.get()), FT_CANCELLED);
  ft_tree_info info = FT_TREE_INFO_INIT;
  ASSERT_EQ(ft_tree_get_info(tree_.get(), &info), FT_OK);
  EXPECT_EQ(info.node_count, 1u);
  settings.progress = nullptr;
  ASSERT_EQ(ft_builder_build_into(builder_.get(), &view_, &settings, tree_.get()), FT_OK);
  ASSERT_EQ(ft_tree_get_hash(tree_.get(), &after), FT_OK);
  EXPECT_EQ(before, after);
}

TEST_F(CApi, EachThreadHasItsOwnErrorText) {
  EXPECT_EQ(ft_builder_create(nullptr), FT_INVALID_ARGUMENT);
  const std::string here = ft_last_error();
  EXPECT_FALSE(here.empty());
  std::thread([] {
    EXPECT_STREQ(ft_last_error(), "");
    EXPECT_EQ(ft_tree_save(nullptr, ""), FT_INVALID_ARGUMENT);
  }).join();
  EXPECT_EQ(ft_last_error(), here);
}

TEST_F(CApi, LongErrorTextsAreShortened) {
  const std::string path(5000, 'x');
  ft_tree* tree = nullptr;
  EXPECT_EQ(ft_tree_load(path.c_str(), &tree), FT_IO_ERROR);
  EXPECT_EQ(std::string(ft_last_error()).size(), 1023u);
}

}  // namespace
}  // namespace fasttree
