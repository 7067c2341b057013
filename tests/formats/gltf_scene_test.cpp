// SPDX-License-Identifier: Apache-2.0
// glTF: nodes, transforms, scenes, and buffers in files.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scene/formats/formats.h"
#include "tests/formats/mesh_writers.h"

namespace fasttree::scene {
namespace {

namespace fs = std::filesystem;
using test::append;
using test::source_of;

std::string triangle_bytes() {
  std::string bytes;
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 4.f}) append(bytes, x);
  return bytes;
}

// One triangle (0,0,0) (1,0,0) (0,2,4) as mesh 0; mesh 1 is the same.
std::string gltf(const std::string& more, const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":")" + uri +
         R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},)"
         R"({"primitives":[{"attributes":{"POSITION":0}},{"attributes":{"POSITION":0}}]}])" +
         more + "}";
}
std::string gltf(const std::string& more) {
  return gltf(more, "data:;base64," + test::base64(triangle_bytes()));
}

Mesh good(const std::string& text) {
  Result<Mesh> mesh = parse_gltf(source_of(text));
  EXPECT_TRUE(mesh.ok()) << mesh.status().message() << "\n" << text;
  return mesh.ok() ? std::move(mesh).value() : Mesh();
}

void expect_refusal(const std::string& text, const std::string& part) {
  const Result<Mesh> mesh = parse_gltf(source_of(text));
  EXPECT_EQ(mesh.status().code(), StatusCode::bad_input) << text;
  EXPECT_NE(mesh.status().message().find(part), std::string::npos) << mesh.status().message();
}

// The triangle (0,0,0) (1,0,0) (0,2,4) under one node with these properties.
std::vector<Vec3> moved(const std::string& properties) {
  return test::corners_of(good(gltf(R"(,"nodes":[{"mesh":0)" + properties + "}]")));
}

void expect_near(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[i][axis], b[i][axis], 1e-6);
  }
}

TEST(GltfScene, AppliesNodeTransforms) {
  expect_near(moved(""), {{0, 0, 0}, {1, 0, 0}, {0, 2, 4}});
  expect_near(moved(R"(,"translation":[1,2,3])"), {{1, 2, 3}, {2, 2, 3}, {1, 4, 7}});
  expect_near(moved(R"(,"scale":[2,3,-1])"), {{0, 0, 0}, {2, 0, 0}, {0, 6, -4}});
  // A quarter turn about z: x to y, y to -x.
  expect_near(moved(R"(,"rotation":[0,0,0.70710678118654752,0.70710678118654752])"),
              {{0, 0, 0}, {0, 1, 0}, {-2, 0, 4}});
  // A quarter turn about x: y to z, z to -y; about y: z to x, x to -z.
  expect_near(moved(R"(,"rotation":[0.70710678118654752,0,0,0.70710678118654752])"),
              {{0, 0, 0}, {1, 0, 0}, {0, -4, 2}});
  expect_near(moved(R"(,"rotation":[0,0.70710678118654752,0,0.70710678118654752])"),
              {{0, 0, 0}, {0, 0, -1}, {4, 2, 0}});
  // Scale first, then rotation, then translation.
  expect_near(moved(R"(,"translation":[10,0,0],"scale":[3,1,1],)"
                    R"("rotation":[0,0,0.70710678118654752,0.70710678118654752])"),
              {{10, 0, 0}, {10, 3, 0}, {8, 0, 4}});
  // By columns: the last four numbers move.
  expect_near(moved(R"(,"matrix":[1,0,0,0, 0,2,0,0, 5,0,1,0, 7,8,9,1])"),
              {{7, 8, 9}, {8, 8, 9}, {27, 12, 13}});
  expect_refusal(gltf(R"(,"nodes":[{"mesh":0,"matrix":[1,2]}])"), "nodes[0].matrix has to be 16");
  expect_refusal(gltf(R"(,"nodes":[{"mesh":0,"scale":[1,2,"3"]}])"), "scale has to be 3 numbers");
  expect_refusal(gltf(R"(,"nodes":[{"mesh":0,"scale":[1,2,3],)"
                      R"("matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}])"),
                 "Keep one");
}

TEST(GltfScene, MultipliesTransformsDownTheTree) {
  const std::vector<Vec3> corners =
      test::corners_of(good(gltf(R"(,"nodes":[{"scale":[2,2,2],"children":[1],"mesh":0},)"
                                 R"({"translation":[1,0,0],"mesh":0}],"scenes":[{"nodes":[0]}])")));
  expect_near(corners, {{0, 0, 0}, {2, 0, 0}, {0, 4, 8}, {2, 0, 0}, {4, 0, 0}, {2, 4, 8}});
}

TEST(GltfScene, WalksDepthFirstInOrder) {
  // Node i moves by 10^i along x, so that a triangle's place says which nodes are above it.
  const std::string nodes =
      R"(,"nodes":[{"translation":[1,0,0],"mesh":0,"children":[3,1]},)"
      R"({"translation":[10,0,0],"mesh":0},{"translation":[100,0,0],"mesh":0},)"
      R"({"translation":[1000,0,0],"mesh":0,"children":[4]},{"translation":[10000,0,0],"mesh":0}])";
  const auto starts = [&](const std::string& more) {
    std::vector<float> out;
    const Mesh mesh = good(gltf(nodes + more));
    for (std::size_t t = 0; t * 3 < mesh.indices.size(); ++t) {
      out.push_back(mesh.positions[mesh.indices[3 * t]].x);
    }
    return out;
  };
  const std::vector<float> all = {1, 1001, 11001, 11, 100};
  EXPECT_EQ(starts(R"(,"scenes":[{"nodes":[0,2]}])"), all);
  EXPECT_EQ(starts(""), all);  // without a scene, every root
  EXPECT_EQ(starts(R"(,"scene":1,"scenes":[{"nodes":[0]},{"nodes":[2,3]}])"),
            (std::vector<float>{100, 1000, 11000}));
  EXPECT_EQ(starts(R"(,"scenes":[{"nodes":[2]},{"nodes":[0]}])"), std::vector<float>{100});
  EXPECT_EQ(starts(R"(,"scenes":[{}])"), std::vector<float>());
  expect_refusal(gltf(nodes + R"(,"scene":1,"scenes":[{}])"), "scene is 1");
  expect_refusal(gltf(nodes + R"(,"scenes":[{"nodes":[5]}])"), "scenes[0].nodes[0] is 5");
}

TEST(GltfScene, SharesAnAccessorWithinAMesh) {
  const Mesh mesh = good(gltf(R"(,"nodes":[{"mesh":1}])"));
  EXPECT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2}));
}

TEST(GltfScene, TakesMeshesWithoutNodesOnceEach) {
  const Mesh mesh = good(gltf(""));
  EXPECT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 3, 4, 5}));
}

TEST(GltfScene, RefusesCyclesAndSecondParents) {
  expect_refusal(gltf(R"(,"nodes":[{"children":[1]},{"children":[0]}],"scenes":[{"nodes":[0]}])"),
                 "nodes[0] is reached twice");
  expect_refusal(gltf(R"(,"nodes":[{"children":[0]}],"scenes":[{"nodes":[0]}])"), "reached twice");
  expect_refusal(gltf(R"(,"nodes":[{"children":[2]},{"children":[2]},{"mesh":0}])"),
                 "nodes[2] is reached twice");
  expect_refusal(gltf(R"(,"nodes":[{"mesh":0}],"scenes":[{"nodes":[0,0]}])"), "reached twice");
  expect_refusal(gltf(R"(,"nodes":[{"children":[7]}])"), "nodes[0].children[0] is 7");
  expect_refusal(gltf(R"(,"nodes":[{"mesh":2}])"), "nodes[0].mesh is 2");
}

TEST(GltfScene, WalksALongChainWithoutRecursion) {
  std::string nodes = R"(,"nodes":[{"mesh":0})";
  for (int i = 0; i < 100000; ++i) nodes += R"(,{"children":[)" + std::to_string(i) + "]}";
  EXPECT_EQ(good(gltf(nodes + R"(],"scenes":[{"nodes":[100000]}])")).indices.size(), 3u);
}

TEST(GltfScene, RefusesInstancing) {
  expect_refusal(gltf(R"(,"nodes":[{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{}}}])"),
                 "nodes[0] has EXT_mesh_gpu_instancing");
}

class GltfFiles : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) /
            ("fasttree_gltf_" +
             std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(root_);
    fs::create_directories(root_ / "model" / "data");
    write(root_ / "outside.bin", triangle_bytes());
    write(root_ / "model" / "a b.bin", triangle_bytes());
    write(root_ / "model" / "data" / "x.bin", triangle_bytes());
    write(root_ / "model" / "short.bin", triangle_bytes().substr(0, 35));
  }
  void TearDown() override { fs::remove_all(root_); }

  static void write(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  }

  Result<Mesh> load(const std::string& uri) const {
    const fs::path path = root_ / "model" / "scene.gltf";
    write(path, gltf("", uri));
    return load_mesh_file(path.string());
  }
  void expect_refused(const std::string& uri, StatusCode code, const std::string& part) const {
    const Result<Mesh> mesh = load(uri);
    EXPECT_EQ(mesh.status().code(), code) << uri << ": " << mesh.status().message();
    EXPECT_NE(mesh.status().message().find(part), std::string::npos) << mesh.status().message();
  }

  fs::path root_;
};

TEST_F(GltfFiles, ReadsBuffersBelowItsFolder) {
  for (const char* uri : {"a%20b.bin", "a b.bin", "data/x.bin", "./data/x.bin", "data//x%2Ebin"}) {
    const Result<Mesh> mesh = load(uri);
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    EXPECT_EQ(mesh.value().indices.size(), 9u);
    EXPECT_EQ(mesh.value().positions[2], (Vec3{0, 2, 4}));
    EXPECT_EQ(mesh.value().name, "scene");
  }
}

TEST_F(GltfFiles, NeverReadsOutsideItsFolder) {
  const std::string own = "own folder";
  const auto bad = StatusCode::bad_input;
  expect_refused("../outside.bin", bad, own);
  expect_refused("%2e%2e/outside.bin", bad, own);
  expect_refused("data/../../outside.bin", bad, own);
  expect_refused("data/../data/x.bin", bad, own);
  expect_refused((root_ / "outside.bin").string(), bad, own);
  expect_refused("file:///etc/passwd", bad, own);
  expect_refused("https://example.org/x.bin", bad, own);
  expect_refused("..\\\\outside.bin", bad, own);
  expect_refused("x%00.bin", bad, own);
  expect_refused("x%2.bin", bad, own);
  expect_refused("x%zz.bin", bad, own);
  expect_refused("", bad, own);
  fs::create_symlink(root_ / "outside.bin", root_ / "model" / "link.bin");
  expect_refused("link.bin", bad, "leads elsewhere");
  fs::create_directory_symlink(root_, root_ / "model" / "up");
  expect_refused("up/outside.bin", bad, "leads elsewhere");
  expect_refused("missing.bin", StatusCode::io_error, "Put the file beside the glTF");
  expect_refused("data", StatusCode::io_error, "not a regular file");
  expect_refused("short.bin", bad, "buffers[0] has 35 bytes");
}

TEST_F(GltfFiles, InMemoryItHasNoFolder) {
  expect_refusal(gltf("", "data/x.bin"), "without a folder");
}

}  // namespace
}  // namespace fasttree::scene
