// SPDX-License-Identifier: Apache-2.0
#include "render/render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "fasttree/build.h"
#include "render/camera_frame.h"
#include "scene/scene.h"

namespace fasttree::render {
namespace {

// A mesh, its tree and its tracer, at addresses that stay.
struct Model {
  scene::Mesh mesh;
  MeshView view;
  Tree tree;
  std::unique_ptr<Tracer> tracer;

  explicit Model(const std::string& spec) {
    auto made = scene::make_procedural_scene(spec);
    EXPECT_TRUE(made.ok()) << made.status().message();
    mesh = std::move(made).value();
    view = mesh.view();
    finish();
  }
  explicit Model(const MeshView& mesh_view) : view(mesh_view) { finish(); }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  Result<Image> draw(const RenderSettings& settings, RenderStats* stats = nullptr) const {
    return render(tree, *tracer, view, settings, stats);
  }

 private:
  void finish() {
    Builder builder;
    auto built = builder.build(view);
    EXPECT_TRUE(built.ok()) << built.status().message();
    tree = std::move(built).value();
    auto made = Tracer::create(tree, view);
    EXPECT_TRUE(made.ok()) << made.status().message();
    tracer = std::make_unique<Tracer>(std::move(made).value());
  }
};

RenderSettings small_settings(const Model& model, View view = View::tight) {
  RenderSettings settings;
  settings.width = settings.height = 64;
  settings.camera = automatic_camera(model.tree.info().bounds, view, *model.tracer);
  return settings;
}

Image drawn(const Model& model, const RenderSettings& settings, RenderStats* stats = nullptr) {
  auto image = model.draw(settings, stats);
  EXPECT_TRUE(image.ok()) << image.status().message();
  return image.ok() ? std::move(image).value() : Image{};
}

bool same_pixel(const Image& a, const Image& b, std::uint32_t x, std::uint32_t y) {
  const std::size_t i = 3 * (std::size_t{y} * a.width + x);
  return std::equal(&a.rgb[i], &a.rgb[i] + 3, &b.rgb[i]);
}

TEST(Render, HitsAreThoseOfBruteForce) {
  const Model model("scene:knot:3000");
  const RenderSettings settings = small_settings(model);
  RenderStats stats;
  const Image image = drawn(model, settings, &stats);

  // The background alone: the same camera, nothing in front of it.
  const Model nothing{MeshView{}};
  const Image empty = drawn(nothing, settings);
  const CameraFrame frame(settings.camera);
  std::uint64_t hits = 0;
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      const Ray ray = make_ray(frame.eye, frame.direction(x + 0.5, y + 0.5, 64, 64));
      const bool hit = brute_force_closest(model.view, ray).hit();
      hits += hit ? 1 : 0;
      // A shaded pixel is darker than the pale background.
      EXPECT_EQ(!same_pixel(image, empty, x, y), hit) << x << ", " << y;
    }
  }
  EXPECT_EQ(stats.hit_pixels, hits);
  EXPECT_GT(hits, 300u);
  EXPECT_LT(hits, 3000u);
  EXPECT_EQ(stats.primary.rays, 64u * 64u);
  EXPECT_GT(stats.shadow.rays, hits / 4);
  EXPECT_LE(stats.shadow.rays, hits);
  EXPECT_EQ(stats.ao.rays, 0u);
}

TEST(Render, SamePixelsForEveryNumberOfThreads) {
  // Otherwise there are no more threads than processors.
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  const Model model("scene:spheres:5000");
  for (const Mode mode : {Mode::shaded, Mode::heat, Mode::leaves}) {
    RenderSettings settings = small_settings(model);
    settings.width = 200;
    settings.height = 170;
    settings.mode = mode;
    settings.samples = 5;
    settings.ao_samples = 2;
    settings.count_cost = true;
    Image first;
    RenderStats first_stats;
    for (const int threads : {1, 2, 7}) {
      tbb::task_arena(threads).execute([&] {
        RenderStats stats;
        const Image image = drawn(model, settings, &stats);
        if (threads == 1) {
          first = image;
          first_stats = stats;
        }
        EXPECT_TRUE(image == first) << to_string(mode) << " on " << threads << " threads";
        EXPECT_EQ(stats.counters.triangle_tests, first_stats.counters.triangle_tests);
        EXPECT_EQ(stats.counters.inner_steps, first_stats.counters.inner_steps);
        EXPECT_EQ(stats.ao.rays, first_stats.ao.rays);
        EXPECT_EQ(stats.hit_pixels, first_stats.hit_pixels);
      });
    }
  }
}

TEST(Render, CountsItsRays) {
  const Model model("scene:knot:3000");
  RenderSettings settings = small_settings(model);
  settings.samples = 4;
  settings.ao_samples = 3;
  settings.count_cost = true;
  RenderStats stats;
  drawn(model, settings, &stats);
  EXPECT_EQ(stats.primary.rays, 4u * 64u * 64u);
  EXPECT_EQ(stats.ao.rays % 3, 0u);
  EXPECT_GT(stats.ao.rays, 3 * stats.hit_pixels);
  EXPECT_GT(stats.ao.counters.inner_steps, 0u);
  EXPECT_EQ(stats.counters.triangle_tests, stats.primary.counters.triangle_tests +
                                               stats.shadow.counters.triangle_tests +
                                               stats.ao.counters.triangle_tests);
  EXPECT_GT(stats.mrays_per_s, 0);

  settings.shadows = false;
  settings.count_cost = false;
  drawn(model, settings, &stats);
  EXPECT_EQ(stats.shadow.rays, 0u);
  EXPECT_EQ(stats.counters.inner_steps, 0u);
}

// A floor seen from above, a plate over it: the light above casts the plate's shadow.
TEST(Render, ShadowsAndOcclusionDarken) {
  const std::vector<Vec3> positions{{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4},
                                    {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}};
  const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
  MeshView view;
  view.positions = positions.data();
  view.vertex_count = 8;
  view.indices = indices.data();
  view.triangle_count = 4;
  const Model model(view);
  RenderSettings settings;
  settings.width = settings.height = 65;
  settings.camera.eye = {0, 0.5f, 3.5f};  // sees under the plate
  settings.camera.target = {0, 0, 0};
  settings.light = Vec3{0, 6, 0};
  const Image lit = drawn(model, settings);
  settings.shadows = false;
  const Image no_shadow = drawn(model, settings);
  settings.ao_samples = 64;
  settings.ao_radius = 2;
  const Image occluded = drawn(model, settings);
  const auto brightness = [](const Image& image, std::uint32_t x, std::uint32_t y) {
    const std::size_t i = 3 * (std::size_t{y} * image.width + x);
    return int{image.rgb[i]} + image.rgb[i + 1] + image.rgb[i + 2];
  };
  // The centre of the picture is the floor right under the plate; the foreground is open.
  EXPECT_LT(brightness(lit, 32, 32), brightness(no_shadow, 32, 32) - 60);
  EXPECT_LT(brightness(occluded, 32, 32), brightness(no_shadow, 32, 32) - 15);
  EXPECT_EQ(brightness(lit, 32, 64), brightness(no_shadow, 32, 64));
  EXPECT_NEAR(brightness(occluded, 32, 64), brightness(no_shadow, 32, 64), 12);
}

// A surface must not shadow itself: with the light in the camera every visible point is lit.
TEST(Render, NoSelfShadow) {
  for (const float scale : {1e-6f, 1.0f, 1e6f}) {
    auto made = scene::make_procedural_scene("scene:spheres:599");
    ASSERT_TRUE(made.ok());
    scene::Mesh mesh = std::move(made).value();
    for (Vec3& p : mesh.positions) p = p * scale + Vec3{3, 4, 5} * scale;
    const Model model(mesh.view());
    RenderSettings settings = small_settings(model);
    settings.light = settings.camera.eye;
    settings.smooth = false;
    RenderStats stats;
    const Image shadowed = drawn(model, settings, &stats);
    settings.shadows = false;
    const Image plain = drawn(model, settings);
    std::size_t different = 0;
    for (std::uint32_t y = 0; y < 64; ++y)
      for (std::uint32_t x = 0; x < 64; ++x) different += same_pixel(shadowed, plain, x, y) ? 0 : 1;
    EXPECT_GT(stats.hit_pixels, 500u);
    // A ray back to the eye may pass an edge on the other side.
    EXPECT_LE(different, 2u) << "scale " << scale;
  }
}

TEST(Render, GroundIsDrawnButNotCounted) {
  const Model model("scene:knot:2000");
  RenderSettings settings = small_settings(model, View::corner);
  RenderStats without, with;
  const Image a = drawn(model, settings, &without);
  settings.ground = true;
  const Image b = drawn(model, settings, &with);
  EXPECT_FALSE(a == b);
  EXPECT_EQ(with.hit_pixels, without.hit_pixels);
  EXPECT_GT(with.shadow.rays, without.shadow.rays);
}

TEST(Render, EmptyMeshIsBackground) {
  const Model model{MeshView{}};
  for (const Mode mode : {Mode::shaded, Mode::heat, Mode::leaves}) {
    RenderSettings settings = small_settings(model);
    settings.mode = mode;
    settings.ground = true;
    settings.samples = 2;
    settings.ao_samples = 2;
    RenderStats stats;
    const Image image = drawn(model, settings, &stats);
    EXPECT_EQ(stats.hit_pixels, 0u);
    for (std::uint32_t y = 0; y < 64; ++y)
      for (std::uint32_t x = 1; x < 64; ++x)
        EXPECT_TRUE(std::equal(&image.rgb[3 * (y * 64)], &image.rgb[3 * (y * 64)] + 3,
                               &image.rgb[3 * (y * 64 + x)]));
  }
}

TEST(Render, HeatScale) {
  const Model model("scene:knot:5000");
  RenderSettings settings = small_settings(model);
  settings.mode = Mode::heat;
  RenderStats stats;
  const Image image = drawn(model, settings, &stats);
  EXPECT_GT(stats.scale_max, 5);
  EXPECT_GT(stats.mean_cost, 0);
  EXPECT_LT(stats.mean_cost, stats.scale_max);
  const double sum = static_cast<double>(stats.counters.inner_steps + stats.counters.leaf_visits +
                                         stats.counters.triangle_tests);
  EXPECT_NEAR(stats.mean_cost, sum / (64 * 64), 1e-9 * sum);

  settings.heat_max = stats.scale_max;
  EXPECT_TRUE(drawn(model, settings) == image);
  settings.heat_max = 10 * stats.scale_max;
  EXPECT_FALSE(drawn(model, settings, &stats) == image);
  EXPECT_EQ(stats.scale_max, settings.heat_max);
}

TEST(Render, LeavesShowTheMeshAndTheCells) {
  const Model model("scene:knot:5000");
  RenderSettings settings = small_settings(model);
  settings.mode = Mode::leaves;
  Image images[3];
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    settings.slice_axis = axis;
    RenderStats stats;
    images[axis] = drawn(model, settings, &stats);
    EXPECT_GE(stats.scale_max, 1);
  }
  EXPECT_FALSE(images[0] == images[1]);
  EXPECT_FALSE(images[1] == images[2]);
  // Outside of the bounds there is nothing to cut.
  settings.slice_position = 100.0f;
  const Image outside = drawn(model, settings);
  for (const std::uint8_t byte : outside.rgb) ASSERT_EQ(byte, 250);
}

TEST(Render, ProgressGrowsToOneAndCancels) {
  const Model model("scene:knot:2000");
  for (const Mode mode : {Mode::shaded, Mode::heat, Mode::leaves}) {
    RenderSettings settings = small_settings(model);
    settings.mode = mode;
    settings.samples = 2;
    double last = 0;
    settings.progress = [&](const char* stage, double fraction) {
      EXPECT_NE(std::string(stage), "");
      EXPECT_GE(fraction, last);
      last = fraction;
      return true;
    };
    tbb::task_arena(1).execute([&] { drawn(model, settings); });
    EXPECT_DOUBLE_EQ(last, 1.0) << to_string(mode);

    int calls = 0;
    settings.progress = [&](const char*, double) { return ++calls < 3; };
    const auto cancelled = model.draw(settings);
    ASSERT_FALSE(cancelled.ok());
    EXPECT_EQ(cancelled.status().code(), StatusCode::cancelled);
    EXPECT_EQ(calls, 3) << "called again after it said stop";
  }
}

TEST(Render, RefusesBadSettings) {
  const Model model("scene:knot:100");
  const RenderSettings good = small_settings(model);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto refused = [&](auto change) {
    RenderSettings settings = good;
    change(settings);
    const auto image = model.draw(settings);
    return !image.ok() && image.status().code() == StatusCode::invalid_argument &&
           !image.status().message().empty();
  };
  using S = RenderSettings;
  EXPECT_TRUE(refused([](S& s) { s.width = 0; }));
  EXPECT_TRUE(refused([](S& s) { s.height = 0; }));
  EXPECT_TRUE(refused([](S& s) { s.width = 32769; }));
  EXPECT_TRUE(refused([](S& s) { s.width = s.height = 32768; }));
  EXPECT_TRUE(refused([](S& s) { s.samples = 0; }));
  EXPECT_TRUE(refused([](S& s) { s.samples = 4097; }));
  EXPECT_TRUE(refused([](S& s) { s.ao_samples = 4097; }));
  EXPECT_TRUE(refused([](S& s) { s.camera.target = s.camera.eye; }));
  EXPECT_TRUE(refused([&](S& s) { s.camera.eye.x = nan; }));
  EXPECT_TRUE(refused([](S& s) { s.camera.fov_degrees = 0; }));
  EXPECT_TRUE(refused([](S& s) { s.camera.fov_degrees = 180; }));
  EXPECT_TRUE(refused([&](S& s) { s.camera.fov_degrees = nan; }));
  EXPECT_TRUE(refused([&](S& s) { s.light = Vec3{nan, 0, 0}; }));
  EXPECT_TRUE(refused([](S& s) { s.light_radius = -1.0f; }));
  EXPECT_TRUE(refused([](S& s) { s.ao_radius = -1.0f; }));
  EXPECT_TRUE(refused([](S& s) { s.heat_max = -1.0; }));
  EXPECT_TRUE(refused([](S& s) { s.slice_axis = 3; }));
  EXPECT_TRUE(refused([&](S& s) { s.slice_position = nan; }));

  RenderSettings limited = good;
  limited.memory_limit_bytes = 1000;
  EXPECT_EQ(model.draw(limited).status().code(), StatusCode::resource_limit);
}

TEST(Render, NamesOfModes) {
  for (const Mode mode : {Mode::shaded, Mode::heat, Mode::leaves}) {
    const Result<Mode> parsed = parse_mode(to_string(mode));
    ASSERT_TRUE(parsed.ok());
    EXPECT_EQ(parsed.value(), mode);
  }
  EXPECT_EQ(parse_mode("xray").status().code(), StatusCode::invalid_argument);
}

}  // namespace
}  // namespace fasttree::render
