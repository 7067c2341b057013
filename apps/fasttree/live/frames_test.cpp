// SPDX-License-Identifier: Apache-2.0
#include "live/frames.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "live/frame_store.h"

namespace fasttree::live {
namespace {

namespace fs = std::filesystem;

class FramesTest : public testing::Test {
 protected:
  FramesTest() {
    folder_ =
        fs::temp_directory_path() / ("frames_test_" + std::to_string(getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~FramesTest() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  fs::path folder_;
};

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(NaturalOrder, CountsNumbersAsNumbers) {
  const std::vector<std::string> sorted = {
      "",      "1.ply", "2.ply", "9.ply",   "10.ply",   "99",     "100",        "a",      "a1b2",
      "a1b10", "a02b1", "a10",   "a10.ply", "b007.ply", "b7.ply", "b7.ply.bak", "b08.ply"};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    for (std::size_t j = 0; j < sorted.size(); ++j) {
      EXPECT_EQ(natural_less(sorted[i], sorted[j]), i < j) << sorted[i] << " and " << sorted[j];
    }
  }
}

TEST(NaturalOrder, TakesNumbersOfAnyLength) {
  const std::string nines(400, '9');
  EXPECT_TRUE(natural_less("f" + nines, "f1" + std::string(400, '0')));
  EXPECT_FALSE(natural_less("f1" + std::string(400, '0'), "f" + nines));
}

TEST_F(FramesTest, AreTheMeshFilesOfAFolderInNaturalOrder) {
  for (const char* name : {"10.obj", "9.OBJ", "notes.txt", ".8.obj", "11.bin"}) {
    write(name, kTriangle);
  }
  fs::create_directory(folder_ / "7.obj");
  for (const std::string& source : {folder_.string(), folder_.string() + "/"}) {
    const auto frames = list_frames(source);
    ASSERT_TRUE(frames.ok()) << frames.status().message();
    EXPECT_TRUE(frames.value().folder);
    EXPECT_EQ(frames.value().name, folder_.filename().string());
    ASSERT_EQ(frames.value().specs.size(), 2u);
    EXPECT_EQ(frame_label(frames.value(), 0), "9.OBJ");
    EXPECT_EQ(frame_label(frames.value(), 1), "10.obj");
  }
}

TEST_F(FramesTest, FoldersWithoutMeshesAreErrors) {
  const auto empty = list_frames(folder_.string());
  EXPECT_EQ(empty.status().code(), StatusCode::bad_input);
  EXPECT_NE(empty.status().message().find("is empty"), std::string::npos);
  write("notes.txt", "");
  const auto none = list_frames(folder_.string());
  EXPECT_EQ(none.status().code(), StatusCode::bad_input);
  EXPECT_NE(none.status().message().find("no mesh file"), std::string::npos);
}

TEST(Frames, OfProceduralScenesAreALoop) {
  for (const char* source : {"scene:wave", "scene:wave:500", "scene:breakup:1k"}) {
    const auto frames = list_frames(source);
    ASSERT_TRUE(frames.ok());
    ASSERT_EQ(frames.value().specs.size(), 24u) << source;
    for (const std::string& spec : frames.value().specs) {
      EXPECT_TRUE(scene::load_scene(spec).ok()) << spec;
    }
  }
  for (const char* source : {"scene:knot", "scene:wave:500:3", "scene:nothing", "a.ply"}) {
    EXPECT_EQ(list_frames(source).value().specs, std::vector<std::string>{source});
  }
}

TEST(Frames, WhatDoesNotMoveIsToldWhatDoes) {
  EXPECT_NE(not_moving("scene:knot:100").find("scene:wave, scene:breakup"), std::string::npos);
  EXPECT_NE(not_moving("scene:wave:100:3").find("leave the frame's number out"), std::string::npos);
  EXPECT_NE(not_moving("bunny.ply").find("fasttree view"), std::string::npos);
}

TEST(FrameStore, KeepsNoMoreThanItMay) {
  const Frames frames = list_frames("scene:wave:500").value();
  FrameStore one(frames, 0, 0);
  std::uint64_t bytes = 0;
  for (std::size_t f = 0; f < one.size(); ++f) {
    const auto mesh = one.get(f);
    ASSERT_TRUE(mesh.ok());
    bytes = mesh_bytes(*mesh.value());
    EXPECT_EQ(one.held_bytes(), bytes);
    EXPECT_EQ(one.largest_bytes(), bytes);
  }
  ASSERT_GT(bytes, 0u);

  FrameStore five(frames, 0, 5 * bytes + bytes / 2);
  for (std::size_t f = 0; f < 2 * five.size(); ++f) {
    ASSERT_TRUE(five.get(f % five.size()).ok());
    EXPECT_LE(five.held_bytes(), 5 * bytes);
  }

  FrameStore all(frames, 0, ~std::uint64_t{0});
  std::vector<const scene::Mesh*> first;
  for (std::size_t f = 0; f < all.size(); ++f) first.push_back(all.get(f).value());
  for (std::size_t f = 0; f < all.size(); ++f) EXPECT_EQ(all.get(f).value(), first[f]);
  EXPECT_EQ(all.held_bytes(), all.size() * bytes);
}

TEST(FrameStore, HonoursItsLimit) {
  FrameStore store(list_frames("scene:wave:5000").value(), 1000, 0);
  EXPECT_EQ(store.get(0).status().code(), StatusCode::resource_limit);
}

TEST_F(FramesTest, BadFilesAreNamed) {
  write("000.obj", kTriangle);
  write("001.obj", "v 0 0 0\nf 1 2 3\n");
  FrameStore store(list_frames(folder_.string()).value(), 0, 0);
  EXPECT_TRUE(store.get(0).ok());
  const auto bad = store.get(1);
  EXPECT_EQ(bad.status().code(), StatusCode::bad_input);
  EXPECT_NE(bad.status().message().find("001.obj"), std::string::npos);
}

TEST(MeshBounds, AreThoseOfTheTriangles) {
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, -1}, {50, 50, 50}};
  mesh.indices = {0, 1, 2};
  EXPECT_EQ(mesh_bounds(mesh.view()), (Box3{{0, 0, -1}, {1, 2, 0}}));
  mesh.indices.clear();
  EXPECT_TRUE(mesh_bounds(mesh.view()).empty());
}

}  // namespace
}  // namespace fasttree::live
