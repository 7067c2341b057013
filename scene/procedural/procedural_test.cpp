// SPDX-License-Identifier: Apache-2.0
#include "scene/procedural/procedural.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scene/procedural/random.h"
#include "scene/scene.h"

namespace fasttree::scene {
namespace {

Mesh make(const std::string& spec) {
  Result<Mesh> mesh = make_procedural_scene(spec);
  EXPECT_TRUE(mesh.ok()) << spec << ": " << mesh.status().message();
  return mesh.ok() ? std::move(mesh).value() : Mesh{};
}

Status failure(const std::string& spec, const LoadSettings& settings = {}) {
  return make_procedural_scene(spec, settings).status();
}

std::size_t triangles(const Mesh& mesh) {
  return mesh.indices.size() / 3;
}

// What every scene has to be: finite, its indices good, no vertex left over, not flat everywhere.
void expect_sound(const Mesh& mesh, const std::string& spec) {
  ASSERT_GT(triangles(mesh), 0u) << spec;
  std::vector<bool> used(mesh.positions.size());
  for (const std::uint32_t v : mesh.indices) {
    ASSERT_LT(v, mesh.positions.size()) << spec;
    used[v] = true;
  }
  std::size_t unused = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p = mesh.positions[v];
    ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << spec;
    unused += used[v] ? 0 : 1;
  }
  EXPECT_EQ(unused, 0u) << spec;
}

TEST(Procedural, EverySceneAtEverySize) {
  for (const ProceduralInfo& info : procedural_scenes()) {
    for (const char* size : {"", ":1", ":2", ":10", ":100", ":999", ":12345", ":60k"}) {
      const std::string spec = "scene:" + std::string(info.name) + size;
      const Mesh mesh = make(spec);
      expect_sound(mesh, spec);
      EXPECT_EQ(mesh.name, info.name);
    }
  }
}

TEST(Procedural, AboutAsManyTrianglesAsAsked) {
  for (const ProceduralInfo& info : procedural_scenes()) {
    const std::string name = "scene:" + std::string(info.name);
    EXPECT_NEAR(static_cast<double>(triangles(make(name))), info.default_triangles,
                0.02 * info.default_triangles)
        << name;
    for (const double size : {100e3, 250e3, 1e6}) {
      const std::string spec = name + ":" + std::to_string(static_cast<int>(size));
      EXPECT_NEAR(static_cast<double>(triangles(make(spec))), size, 0.02 * size) << spec;
    }
  }
  EXPECT_EQ(triangles(make("scene:cloud:12345")), 12345u);
}

TEST(Procedural, SameSpecSameMesh) {
  for (const ProceduralInfo& info : procedural_scenes()) {
    const std::string spec = "scene:" + std::string(info.name) + ":20000";
    const Mesh a = make(spec), b = make(spec);
    EXPECT_EQ(a.positions, b.positions) << spec;
    EXPECT_EQ(a.indices, b.indices) << spec;
  }
}

TEST(Procedural, FewDegenerateTriangles) {
  for (const ProceduralInfo& info : procedural_scenes()) {
    const Mesh mesh = make("scene:" + std::string(info.name) + ":100k");
    std::size_t flat = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const Vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                 c = mesh.positions[mesh.indices[i + 2]];
      const Vec3 n = cross(b - a, c - a);
      flat += dot(n, n) > 0 ? 0 : 1;
    }
    EXPECT_LT(static_cast<double>(flat), 0.01 * static_cast<double>(triangles(mesh))) << info.name;
  }
}

TEST(Procedural, AnimatedScenesLoopWithTheSameTriangles) {
  int animated = 0;
  for (const ProceduralInfo& info : procedural_scenes()) {
    if (info.frames == 1) continue;
    ++animated;
    const std::string name = "scene:" + std::string(info.name) + ":5000:";
    const Mesh first = make(name + "0");
    EXPECT_EQ(first.positions, make("scene:" + std::string(info.name) + ":5000").positions);
    for (std::uint32_t frame = 1; frame < info.frames; ++frame) {
      const Mesh mesh = make(name + std::to_string(frame));
      expect_sound(mesh, name);
      EXPECT_EQ(mesh.indices, first.indices) << name << frame;
      EXPECT_NE(mesh.positions, first.positions) << name << frame;
    }
    EXPECT_EQ(make(name + std::to_string(info.frames)).positions, first.positions);
    EXPECT_EQ(make(name + "4294967295").indices, first.indices);
  }
  EXPECT_GE(animated, 1);
}

TEST(Procedural, SizesWithSuffixes) {
  EXPECT_EQ(triangles(make("scene:cloud:3k")), 3000u);
  EXPECT_EQ(triangles(make("scene:cloud:1M")), 1'000'000u);
  EXPECT_EQ(triangles(make("scene:wave::3")), triangles(make("scene:wave")));
}

TEST(Procedural, RefusesWhatItCannotRead) {
  for (const char* spec : {"knot",
                           "scene:knot:",
                           "scene:knot:0",
                           "scene:knot:-1",
                           "scene:knot:+5",
                           "scene:knot:abc",
                           "scene:knot:1.5",
                           "scene:knot:1e6",
                           "scene:knot:k",
                           "scene:knot:100000001",
                           "scene:knot:101M",
                           "scene:knot:18446744073709551616",
                           "scene:knot:18446744073709551615k",
                           "scene:knot:100 ",
                           "scene:knot:100:0",
                           "scene:wave:100:-1",
                           "scene:wave:100:x",
                           "scene:wave:100:1k",
                           "scene:wave:100:",
                           "scene:wave:100:4294967296",
                           "scene:wave:1:1:1",
                           "scene:",
                           "scene",
                           "",
                           "scene:Knot"}) {
    const Status status = failure(spec);
    if (std::string(spec) == "scene:knot:") {
      EXPECT_TRUE(status.ok()) << "an empty size is the default one";
      continue;
    }
    EXPECT_EQ(status.code(), StatusCode::invalid_argument) << spec;
    EXPECT_FALSE(status.message().empty()) << spec;
  }
}

TEST(Procedural, UnknownNamesGetTheNearestOne) {
  const Status status = failure("scene:noth:1000");
  EXPECT_EQ(status.code(), StatusCode::invalid_argument);
  EXPECT_NE(status.message().find("nearest: scene:knot"), std::string::npos) << status.message();
  for (const ProceduralInfo& info : procedural_scenes())
    EXPECT_NE(status.message().find(info.name), std::string::npos);
  // A long name neither takes long nor is repeated in full.
  EXPECT_LT(failure("scene:" + std::string(1'000'000, 'x')).message().size(), 400u);
}

TEST(Procedural, HonoursTheMemoryLimit) {
  LoadSettings settings;
  settings.memory_limit_bytes = 1'000'000;
  for (const ProceduralInfo& info : procedural_scenes()) {
    const std::string name = "scene:" + std::string(info.name);
    EXPECT_EQ(failure(name + ":100M", settings).code(), StatusCode::resource_limit) << name;
    EXPECT_TRUE(make_procedural_scene(name + ":9000", settings).ok()) << name;
  }
}

TEST(Random, UniformAndReproducible) {
  double sum = 0;
  for (std::uint64_t i = 0; i < 10000; ++i) {
    const double x = uniform(1, i);
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
    sum += x;
  }
  EXPECT_NEAR(sum / 10000, 0.5, 0.02);
  EXPECT_EQ(mix(0), 0xe220a8397b1dcdafu);  // the first output of SplitMix64 seeded with 0
  EXPECT_NE(uniform(1, 5), uniform(2, 5));
}

}  // namespace
}  // namespace fasttree::scene
