// SPDX-License-Identifier: Apache-2.0
// Files on disk: which reader takes them, mapping, names, and the benchmark scenes where present.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "fasttree/mesh.h"
#include "scene/mapped_file.h"
#include "scene/scene.h"
#include "tests/formats/mesh_writers.h"

namespace fasttree::scene {
namespace {

namespace fs = std::filesystem;

const test::TriangleMesh kTwo = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3}};

class Load : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) /
            ("fasttree_load_" +
             std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = (root_ / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  void expect_loads(const std::string& name, const std::string& bytes) const {
    const Result<Mesh> mesh = load_scene(write(name, bytes));
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    EXPECT_TRUE(test::same_bits(test::corners_of(mesh.value()), test::corners_of(kTwo))) << name;
    EXPECT_TRUE(validate(mesh.value().view()).ok());
    EXPECT_EQ(mesh.value().name, "mesh");
  }
  void expect_refused(const std::string& path, StatusCode code, const std::string& part) const {
    const Result<Mesh> mesh = load_scene(path);
    EXPECT_EQ(mesh.status().code(), code) << path << ": " << mesh.status().message();
    EXPECT_NE(mesh.status().message().find(part), std::string::npos) << mesh.status().message();
    EXPECT_TRUE(mesh.status().message().starts_with(path)) << mesh.status().message();
  }

  fs::path root_;
};

TEST_F(Load, GoesByExtension) {
  expect_loads("mesh.ply", test::write_ply_ascii(kTwo));
  expect_loads("mesh.PLY", test::write_ply_binary(kTwo, false));
  expect_loads("mesh.obj", test::write_obj(kTwo));
  expect_loads("mesh.stl", test::write_stl_ascii(kTwo));
  expect_loads("mesh.Stl", test::write_stl_binary(kTwo, "solid"));
  expect_loads("mesh.gltf", test::write_gltf(kTwo));
  expect_loads("mesh.glb", test::write_glb(kTwo));
}

TEST_F(Load, GoesByContentWhereTheNameSaysNothingOrIsWrong) {
  expect_loads("mesh", test::write_ply_binary(kTwo, true));
  expect_loads("mesh.obj", test::write_ply_binary(kTwo, false));
  expect_loads("mesh.stl", test::write_glb(kTwo));
  expect_loads("mesh.bin", test::write_stl_binary(kTwo, ""));
  expect_loads("mesh.txt", test::write_stl_ascii(kTwo));
  expect_loads("mesh.json", test::write_gltf(kTwo));
}

TEST_F(Load, SaysWhatCanBeRead) {
  expect_refused(write("mesh.xyz", "0 0 0\n"), StatusCode::bad_input,
                 "PLY, OBJ, STL, glTF and GLB");
  expect_refused(write("mesh", "0 0 0\n"), StatusCode::bad_input, "PLY, OBJ, STL, glTF and GLB");
  expect_refused(write("mesh.ply", ""), StatusCode::bad_input, "empty");
  expect_refused(write("mesh.ply.gz", "\x1f\x8b\x08"), StatusCode::bad_input, "Unpack");
  expect_refused(write("mesh.ply", "v 0 0 0\n"), StatusCode::bad_input, "begins with a line 'ply'");
  expect_refused((root_ / "missing.ply").string(), StatusCode::io_error, "No such file");
  expect_refused(root_.string(), StatusCode::io_error, "not a regular file");
  const std::string pipe = (root_ / "pipe.ply").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_refused(pipe, StatusCode::io_error, "not a regular file");
}

TEST_F(Load, NamesAnUnreadableFile) {
  const std::string path = write("mesh.ply", test::write_ply_ascii(kTwo));
  fs::permissions(path, fs::perms::none);
  if (::access(path.c_str(), R_OK) == 0) GTEST_SKIP() << "this user can read every file";
  expect_refused(path, StatusCode::io_error, "Permission denied");
}

TEST_F(Load, KeepsTheMappingAsLongAsTheMesh) {
  const std::string path = write("mesh.ply", test::write_ply_binary(kTwo, false));
  Result<Mesh> loaded = load_mesh_file(path);
  ASSERT_TRUE(loaded.ok());
  Mesh mesh = std::move(loaded).value();
  ASSERT_NE(mesh.mapped_positions, nullptr);
  EXPECT_TRUE(mesh.positions.empty());
  fs::remove(path);  // the mapping stays
  const Mesh copy = mesh;
  mesh = Mesh();
  EXPECT_TRUE(test::same_bits(test::corners_of(copy), test::corners_of(kTwo)));
}

TEST_F(Load, NoticesThatAMappedFileWasCut) {
  const std::string path = write("mesh.ply", std::string(10000, 'x'));
  const Result<std::shared_ptr<const MappedFile>> file = MappedFile::open(path);
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file.value()->bytes().size(), 10000u);
  EXPECT_TRUE(file.value()->still_whole());
  fs::resize_file(path, 9999);
  EXPECT_FALSE(file.value()->still_whole());
}

TEST_F(Load, ATruncatedFileIsRefusedNotMappedPastItsEnd) {
  // Positions over many pages, cut in the middle of them.
  const test::TriangleMesh large = test::random_mesh(1, 100000, 10);
  const std::string bytes = test::write_ply_binary(large, false);
  expect_refused(write("mesh.ply", bytes.substr(0, bytes.size() / 2)), StatusCode::bad_input,
                 "truncated");
}

TEST_F(Load, HonoursTheMemoryLimitWithPositionsInPlace) {
  const std::string path = write("mesh.ply", test::write_ply_binary(kTwo, false));
  LoadSettings settings;
  settings.memory_limit_bytes = 2 * 12;  // the indices; the positions stay in the file
  EXPECT_TRUE(load_mesh_file(path, settings).ok());
  --settings.memory_limit_bytes;
  EXPECT_EQ(load_mesh_file(path, settings).status().code(), StatusCode::resource_limit);
}

TEST(MeshView, OfAMeshWithoutTrianglesHasNone) {
  Mesh mesh;
  EXPECT_EQ(mesh.view().triangle_count, 0u);
  mesh.positions.resize(6);
  EXPECT_EQ(mesh.view().triangle_count, 0u);
  EXPECT_EQ(mesh.view().vertex_count, 6u);
}

TEST(BenchmarkScenes, HaveTheirCounts) {
  const fs::path folder = FASTTREE_SCENES;
  if (!fs::exists(folder / "bunny.ply")) {
    GTEST_SKIP() << "no benchmark scenes beside the project";
  }
  struct Expected {
    std::string file;
    std::uint32_t triangles;
    std::uint32_t vertices;
    Vec3 lo;
    Vec3 hi;
  };
  std::vector<Expected> scenes = {
      {"bunny.ply",
       69451,
       35947,
       {-0.09469f, 0.032987f, -0.061874f},
       {0.061009f, 0.18732f, 0.0588f}},
      {"sibenik.ply", 80479, 79596, {-57.999f, -1.999f, -35.001f}, {68.001f, 30.601f, 44.999f}},
      {"dragon.ply",
       871414,
       437645,
       {-0.10832f, 0.052729f, -0.050414f},
       {0.096566f, 0.19717f, 0.041207f}},
      {"dragon_res2.ply",
       202520,
       100250,
       {-0.10819f, 0.052739f, -0.050345f},
       {0.096406f, 0.19714f, 0.041137f}},
      {"buddha_100k.ply",
       100000,
       49950,
       {-0.46095f, -1.0022f, -0.32388f},
       {0.35222f, 0.9775f, 0.49018f}},
      {"sponza.ply", 66447, 60848, {-17.403f, -0.90669f, -7.7985f}, {17.417f, 15.653f, 7.8015f}}};
  for (int frame = 0; frame < 24; ++frame) {
    const std::string number = (frame < 10 ? "00" : "0") + std::to_string(frame);
    scenes.push_back({"pigman_run/" + number + ".ply", 35706, 25973, {}, {}});
  }
  for (const Expected& expected : scenes) {
    SCOPED_TRACE(expected.file);
    const Result<Mesh> mesh = load_scene((folder / expected.file).string());
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    const MeshView view = mesh.value().view();
    EXPECT_EQ(view.triangle_count, expected.triangles);
    EXPECT_EQ(view.vertex_count, expected.vertices);
    EXPECT_NE(mesh.value().mapped_positions, nullptr);
    EXPECT_TRUE(validate(view).ok());
    if (expected.lo == expected.hi) continue;
    Box3 box;
    for (std::uint32_t v = 0; v < view.vertex_count; ++v) box.include(view.position(v));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(box.lo[axis], expected.lo[axis], 1e-4 * std::abs(expected.lo[axis]));
      EXPECT_NEAR(box.hi[axis], expected.hi[axis], 1e-4 * std::abs(expected.hi[axis]));
    }
  }
}

}  // namespace
}  // namespace fasttree::scene
