// SPDX-License-Identifier: Apache-2.0
#include "live/frame_tracer.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "live/heat_frame.h"
#include "live/overlay.h"
#include "live/ray_grid.h"
#include "live/rebuild.h"
#include "live/series.h"
#include "scene/scene.h"

namespace fasttree::live {
namespace {

struct Scene {
  scene::Mesh mesh;
  Rebuild rebuild;

  explicit Scene(scene::Mesh m) : mesh(std::move(m)) {
    EXPECT_TRUE(rebuild.run(mesh.view(), {}).ok());
  }
  explicit Scene(const std::string& spec) : Scene(scene::load_scene(spec).value()) {}

  Shot shot() const {
    Shot shot;
    shot.camera = render::automatic_camera(rebuild.tree().info().bounds, render::View::corner);
    shot.light = place_light(shot.camera, rebuild.tracer());
    return shot;
  }
};

std::array<std::uint8_t, 3> pixel(const render::Image& image, std::uint32_t x, std::uint32_t y) {
  const std::size_t i = 3 * (std::size_t{y} * image.width + x);
  return {image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]};
}

TEST(TileOrder, HasEveryPixelOnce) {
  for (const auto& [width, height] :
       {std::pair{1u, 1u}, {8u, 8u}, {37u, 21u}, {16u, 9u}, {5u, 40u}}) {
    const TileOrder order(width, height);
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    std::size_t next = 0;
    for (std::size_t i = 0; i < order.tiles(); ++i) {
      const TileOrder::Tile tile = order.tile(i);
      EXPECT_EQ(tile.first, next);
      for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
        for (std::uint32_t x = tile.x0; x < tile.x1; ++x, ++next) seen.insert({x, y});
      }
    }
    EXPECT_EQ(next, order.pixels());
    EXPECT_EQ(seen.size(), order.pixels());
  }
  EXPECT_EQ(TileOrder(24, 16).tile(4).first, 4u * 64);
}

TEST(RayGrid, GoesThroughThePixelsOfTheRenderer) {
  const Scene scene("scene:knot:500");
  const render::Camera camera = scene.shot().camera;
  const RayGrid grid(camera, 40, 30);
  const render::CameraFrame frame(camera);
  for (std::uint32_t y = 0; y < 30; y += 7) {
    for (std::uint32_t x = 0; x < 40; x += 3) {
      const Ray ray = grid.ray(x, y);
      const render::Double3 way = render::normalized(render::Double3(ray.direction));
      EXPECT_LT(render::length(way - frame.direction(x + 0.5, y + 0.5, 40, 30)), 1e-6);
      EXPECT_EQ(ray.origin, camera.eye);
    }
  }
}

TEST(FrameTracer, SeesWhatBruteForceSees) {
  const Scene scene("scene:knot:2000");
  constexpr std::uint32_t kWidth = 45, kHeight = 30;
  FrameTracer tracer(kWidth, kHeight);
  const Shot shot = scene.shot();
  const TraceFigures figures = tracer.trace(scene.rebuild.tracer(), scene.mesh.view(), shot);
  render::Image image;
  tracer.shade(image);
  ASSERT_EQ(image.rgb.size(), 3u * kWidth * kHeight);

  const RayGrid grid(shot.camera, kWidth, kHeight);
  std::uint64_t hits = 0;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    // Pixel (0, y) is background: the picture is wider than the knot.
    const auto background = pixel(image, 0, y);
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const bool hit = brute_force_closest(scene.mesh.view(), grid.ray(x, y)).hit();
      hits += hit ? 1 : 0;
      EXPECT_EQ(pixel(image, x, y) != background, hit) << x << " " << y;
    }
  }
  EXPECT_EQ(figures.primary_rays, kWidth * kHeight);
  EXPECT_EQ(figures.hits, hits);
  EXPECT_GT(figures.shadow_rays, hits / 4);
  EXPECT_LE(figures.shadow_rays, hits);
  EXPECT_GT(figures.lit, 0u);
  EXPECT_LT(figures.lit, figures.shadow_rays);  // a knot shadows itself
}

TEST(FrameTracer, CastsShadows) {
  // A floor seen from above, and a small square that hovers over a part of it.
  scene::Mesh mesh;
  const auto square = [&](float size, float x, float height) {
    const auto i = static_cast<std::uint32_t>(mesh.positions.size());
    for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      mesh.positions.push_back(
          {x + size * static_cast<float>(a), height, size * static_cast<float>(b)});
    }
    mesh.indices.insert(mesh.indices.end(), {i, i + 1, i + 2, i, i + 2, i + 3});
  };
  square(10, 0, 0);
  square(0.5f, 2, 2);
  const Scene scene(mesh);
  Shot shot;
  shot.camera.eye = {0, 8, 0};
  shot.camera.target = {0, 0, 0};
  shot.camera.up = {0, 0, -1};
  shot.light = {4, 4, 0};  // the shadow falls around x = 0
  FrameTracer tracer(64, 64);
  render::Image dark, light;
  tracer.trace(scene.rebuild.tracer(), scene.mesh.view(), shot);
  tracer.shade(dark);
  shot.shadows = false;
  const TraceFigures none = tracer.trace(scene.rebuild.tracer(), scene.mesh.view(), shot);
  tracer.shade(light);
  EXPECT_EQ(none.shadow_rays, 0u);
  EXPECT_LT(pixel(dark, 32, 32)[0] + 40, pixel(light, 32, 32)[0]);
  EXPECT_EQ(pixel(dark, 10, 10), pixel(light, 10, 10));
}

TEST(FrameTracer, ThePictureDoesNotDependOnThreads) {
  const Scene scene("scene:breakup:2000:5");
  const auto draw = [&](int threads) {
    render::Image image;
    tbb::task_arena(threads).execute([&] {
      FrameTracer tracer(61, 43);
      tracer.trace(scene.rebuild.tracer(), scene.mesh.view(), scene.shot());
      tracer.shade(image);
    });
    return image;
  };
  EXPECT_EQ(draw(1), draw(4));
}

TEST(FrameTracer, AnEmptyMeshIsBackground) {
  const Scene scene{scene::Mesh()};
  FrameTracer tracer(20, 20);
  const TraceFigures figures =
      tracer.trace(scene.rebuild.tracer(), scene.mesh.view(), scene.shot());
  EXPECT_EQ(figures.hits, 0u);
  EXPECT_EQ(figures.shadow_rays, 0u);
  render::Image image;
  tracer.shade(image);
  EXPECT_EQ(pixel(image, 0, 7), pixel(image, 19, 7));
}

TEST(Rebuild, IsAsIfBuiltAnew) {
  Rebuild again;
  for (const char* spec : {"scene:wave:3000:0", "scene:breakup:500:7", "scene:wave:3000:9"}) {
    const scene::Mesh mesh = scene::load_scene(spec).value();
    ASSERT_TRUE(again.run(mesh.view(), {}).ok());
    const Tree fresh = Builder().build(mesh.view(), {}).value();
    EXPECT_EQ(again.tree().hash(), fresh.hash()) << spec;
    EXPECT_FALSE(again.stages().empty());
    EXPECT_EQ(again.build_ms(), again.tree_ms() + again.layout_ms());
  }
}

TEST(PlaceLight, StaysUnderACeiling) {
  const Scene scene("scene:hall:25000");
  const render::Camera camera = render::automatic_camera(
      scene.rebuild.tree().info().bounds, render::View::inside, scene.rebuild.tracer());
  const Vec3 light = place_light(camera, scene.rebuild.tracer());
  Ray ray;
  ray.origin = camera.eye;
  ray.direction = light - camera.eye;
  ray.t_max = 1;
  EXPECT_FALSE(scene.rebuild.tracer().occluded(ray));
}

TEST(HeatFrame, ShowsWhatRaysCost) {
  const Scene scene("scene:knot:2000");
  HeatFrame frame(200, 170);
  render::Image image;
  const HeatFigures figures = frame.draw(scene.rebuild.tracer(), scene.shot().camera, image);
  ASSERT_EQ(image.rgb.size(), 3u * 200 * 170);
  EXPECT_GT(figures.mean_cost, 1);
  EXPECT_GT(figures.scale_max, figures.mean_cost);
  const auto brightness = [&](std::uint32_t x, std::uint32_t y) {
    const auto p = pixel(image, x, y);
    return p[0] + p[1] + p[2];
  };
  // The knot's tube costs more than the empty corner.
  EXPECT_GT(brightness(100, 45), brightness(1, 1));
}

TEST(HeatFrame, ScalesEndAtRoundNumbers) {
  EXPECT_EQ(round_scale(0), 1);
  EXPECT_EQ(round_scale(1), 1);
  EXPECT_EQ(round_scale(1.5), 2);
  EXPECT_EQ(round_scale(21), 50);
  EXPECT_EQ(round_scale(50), 50);
  EXPECT_EQ(round_scale(51), 100);
  EXPECT_EQ(round_scale(730), 1000);
}

TEST(Overlay, DrawsInItsCornerOnly) {
  render::Image image{400, 300, std::vector<std::uint8_t>(3 * 400 * 300, 200)};
  draw_overlay(image, {{"build", "1.25 ms", false}, {"grid", "0.5 ms", true}});
  EXPECT_EQ(pixel(image, 0, 0)[0], 50);
  EXPECT_EQ(pixel(image, 399, 0)[0], 200);
  EXPECT_EQ(pixel(image, 0, 299)[0], 200);
  EXPECT_GT(*std::max_element(image.rgb.begin(), image.rgb.end()), 230);  // letters
  for (const std::uint32_t side : {1u, 9u, 30u}) {
    render::Image small{side, side, std::vector<std::uint8_t>(std::size_t{3} * side * side, 200)};
    draw_overlay(small, {{"frames a second", "1234", false}});
    EXPECT_LE(pixel(small, 0, 0)[0], 50);
  }
}

TEST(Series, KeepsTheLastValues) {
  Series series;
  EXPECT_EQ(series.median(), 0);
  EXPECT_EQ(series.recent(), 0);
  for (const double value : {5.0, 1.0, 3.0}) series.add(value);
  EXPECT_EQ(series.median(), 3);
  EXPECT_EQ(series.worst(), 5);
  EXPECT_EQ(series.recent(), 3);
  for (std::size_t i = 0; i < Series::kKept + 10; ++i) series.add(7);
  EXPECT_EQ(series.median(), 7);
  EXPECT_EQ(series.worst(), 7);
  for (int i = 0; i < 16; ++i) series.add(i);
  EXPECT_EQ(series.recent(), 7.5);
}

}  // namespace
}  // namespace fasttree::live
