// SPDX-License-Identifier: Apache-2.0
#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fasttree/build.h"
#include "render/camera_frame.h"
#include "scene/scene.h"

namespace fasttree::render {
namespace {

TEST(Camera, OutsideAndTight) {
  const Box3 bounds{{-1, 0, 2}, {3, 3, 14}};  // extent 4, 3, 12: diagonal 13
  const Camera outside = automatic_camera(bounds);
  EXPECT_EQ(outside.eye, (Vec3{1, 1.5f, 8 + 19.5f}));
  EXPECT_EQ(outside.target, (Vec3{1, 1.5f, 8}));
  EXPECT_EQ(outside.fov_degrees, 60.0f);
  EXPECT_EQ(automatic_camera(bounds, View::tight).eye, (Vec3{1, 1.5f, 8 + 9.75f}));
}

TEST(Camera, CornerShowsAllOfTheBounds) {
  for (const Box3& bounds : {Box3{{0, 0, 0}, {1, 1, 1}}, Box3{{-50, 0, 3}, {50, 1, 4}},
                             Box3{{0, 0, 0}, {0, 20, 0}}, Box3{{5, 5, 5}, {6, 5, 9}}}) {
    const Camera camera = automatic_camera(bounds, View::corner);
    const CameraFrame frame(camera);
    double largest = 0;
    for (int i = 0; i < 8; ++i) {
      const Double3 corner{(i & 1) != 0 ? bounds.hi.x : bounds.lo.x,
                           (i & 2) != 0 ? bounds.hi.y : bounds.lo.y,
                           (i & 4) != 0 ? bounds.hi.z : bounds.lo.z};
      const Double3 d = corner - frame.eye;
      const double depth = dot(d, frame.forward);
      ASSERT_GT(depth, 0);
      for (const Double3& side : {frame.right, frame.up})
        largest = std::max(largest, std::fabs(dot(d, side)) / (depth * frame.half_side));
    }
    EXPECT_LT(largest, 1.0);
    EXPECT_GT(largest, 0.8) << "the picture is mostly empty";
  }
}

TEST(Camera, AlwaysUsable) {
  const float big = 1e30f;
  for (const Box3& bounds :
       {Box3{}, Box3{{0, 0, 0}, {0, 0, 0}}, Box3{{1e8f, 1e8f, 1e8f}, {1e8f, 1e8f, 1e8f}},
        Box3{{1e10f, 0, 1e10f}, {1e10f, 1, 1e10f}}, Box3{{-big, -big, -big}, {big, big, big}},
        Box3{{0, 0, 0}, {1e-30f, 1e-30f, 1e-30f}}}) {
    for (const View view : {View::outside, View::tight, View::corner, View::inside}) {
      const Camera camera = automatic_camera(bounds, view);
      EXPECT_TRUE(finite(camera.eye) && finite(camera.target));
      EXPECT_FALSE(camera.eye == camera.target);
    }
  }
}

TEST(Camera, NamesOfViews) {
  for (const View view : {View::outside, View::tight, View::corner, View::inside}) {
    const Result<View> parsed = parse_view(to_string(view));
    ASSERT_TRUE(parsed.ok());
    EXPECT_EQ(parsed.value(), view);
  }
  const Result<View> bad = parse_view("above");
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.status().code(), StatusCode::invalid_argument);
  EXPECT_NE(bad.status().message().find("inside"), std::string::npos);
}

TEST(CameraFrame, DirectionsAgreeWithTheFieldOfView) {
  Camera camera;
  camera.eye = {0, 0, 5};
  camera.fov_degrees = 90;
  const CameraFrame frame(camera);
  const Double3 centre = frame.direction(50, 25, 100, 50);
  EXPECT_NEAR(centre.z, -1, 1e-12);
  const Double3 top = frame.direction(50, 0, 100, 50);
  EXPECT_NEAR(top.y, std::sqrt(0.5), 1e-12);
  const Double3 right = frame.direction(100, 25, 100, 50);
  EXPECT_NEAR(right.x / -right.z, 2, 1e-12) << "pixels are square";
  const Double3 side = frame.direction(50, 50, 50, 100);
  EXPECT_NEAR(side.x, std::sqrt(0.5), 1e-12) << "the angle is that of the shorter side";
}

TEST(CameraFrame, UpAlongTheViewIsReplaced) {
  Camera camera;
  camera.up = {0, 0, 2};
  const CameraFrame frame(camera);
  EXPECT_NEAR(length(frame.right), 1, 1e-12);
  EXPECT_NEAR(dot(frame.up, frame.forward), 0, 1e-12);
}

TEST(Camera, FindsThePlaceInsideAHall) {
  const Result<scene::Mesh> mesh = scene::make_procedural_scene("scene:hall:30k");
  ASSERT_TRUE(mesh.ok());
  const MeshView view = mesh.value().view();
  Builder builder;
  const Result<Tree> tree = builder.build(view);
  ASSERT_TRUE(tree.ok()) << tree.status().message();
  const Result<Tracer> tracer = Tracer::create(tree.value(), view);
  ASSERT_TRUE(tracer.ok());
  const Box3 bounds = tree.value().info().bounds;
  const Camera camera = automatic_camera(bounds, View::inside, tracer.value());
  EXPECT_EQ(camera, automatic_camera(bounds, View::inside, tracer.value()));
  EXPECT_GT(camera.eye.y, 0.5f);
  EXPECT_LT(camera.eye.y, 12.0f);
  EXPECT_LT(std::fabs(camera.eye.x), 9.0f);
  const Vec3 ahead = camera.target - camera.eye;
  EXPECT_GT(std::fabs(ahead.z), std::fabs(ahead.x)) << "looks along the hall";
  EXPECT_GT(std::fabs(ahead.z), 9.0f);
}

}  // namespace
}  // namespace fasttree::render
