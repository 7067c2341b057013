// SPDX-License-Identifier: Apache-2.0
#include "live/orbit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/camera_frame.h"

namespace fasttree::live {
namespace {

using render::Double3;

std::vector<render::Camera> cameras() {
  std::vector<render::Camera> result(4);
  result[0].eye = {3, 2, 5};
  result[0].target = {1, 1, 1};
  result[1].eye = {-1, -4, 0.5f};
  result[1].up = {0, 0, 1};
  result[2].eye = {1e-5f, 3e-5f, 1e-5f};
  result[3].eye = {1000, 2000, 1500};
  result[3].target = {1001, 2000.5f, 1500};
  result[3].up = {1, 2, 0.5f};
  result[3].fov_degrees = 30;
  return result;
}

double distance(const render::Camera& camera) {
  return render::length(Double3(camera.eye) - Double3(camera.target));
}

void expect_same(const render::Camera& a, const render::Camera& b) {
  const double close = 1e-5 * (distance(b) + render::max_component(Double3(b.eye)));
  EXPECT_LT(render::length(Double3(a.eye) - Double3(b.eye)), close);
  EXPECT_LT(render::length(Double3(a.target) - Double3(b.target)), close);
  EXPECT_EQ(a.up, b.up);
  EXPECT_EQ(a.fov_degrees, b.fov_degrees);
}

/// Where a point is in the picture: to the right and upwards, by the tangents of the angles.
std::pair<double, double> seen(const render::Camera& camera, Double3 point) {
  const render::CameraFrame frame(camera);
  const Double3 way = point - frame.eye;
  const double depth = render::dot(way, frame.forward);
  return {render::dot(way, frame.right) / depth, render::dot(way, frame.up) / depth};
}

TEST(OrbitCamera, BeginsWhereItIsPut) {
  for (const render::Camera& start : cameras()) expect_same(OrbitCamera(start).camera(), start);
}

TEST(OrbitCamera, ComesBack) {
  for (const render::Camera& start : cameras()) {
    OrbitCamera orbit(start);
    orbit.turn(0.7, 0.2);
    orbit.pan(0.4, -0.6);
    orbit.zoom(-3);
    orbit.reset();
    expect_same(orbit.camera(), start);
    orbit.turn(2, 0);  // a full turn
    expect_same(orbit.camera(), start);
    orbit.pan(0.5, 0.25);
    orbit.pan(-0.5, -0.25);
    orbit.zoom(4);
    orbit.zoom(-4);
    expect_same(orbit.camera(), start);
  }
}

TEST(OrbitCamera, TurnsAroundItsTarget) {
  for (const render::Camera& start : cameras()) {
    OrbitCamera orbit(start);
    orbit.turn(0.3, -0.1);
    const render::Camera turned = orbit.camera();
    EXPECT_EQ(turned.target, start.target);
    EXPECT_NEAR(distance(turned) / distance(start), 1, 1e-3);
    EXPECT_NE(turned.eye, start.eye);
  }
}

TEST(OrbitCamera, ThingsFollowTheHand) {
  const render::Camera start = cameras()[0];
  // A point on this side of the target, where the hand takes hold of it.
  const Double3 near = Double3(start.target) + (Double3(start.eye) - Double3(start.target)) * 0.3;
  OrbitCamera orbit(start);
  orbit.turn(0.05, 0);
  EXPECT_GT(seen(orbit.camera(), near).first, 0.01);
  orbit.reset();
  orbit.turn(0, 0.05);
  EXPECT_LT(seen(orbit.camera(), near).second, -0.01);
  EXPECT_GT(orbit.camera().eye.y, start.eye.y);
}

TEST(OrbitCamera, NeverTurnsOver) {
  for (const double way : {1.0, -1.0}) {
    OrbitCamera orbit(cameras()[0]);
    for (int i = 0; i < 50; ++i) orbit.turn(0.1, 0.2 * way);
    const render::CameraFrame frame(orbit.camera());
    EXPECT_GT(frame.up.y, 0);
    EXPECT_LT(frame.up.y, 0.1);
    EXPECT_LT(frame.forward.y * way, -0.99);
  }
}

TEST(OrbitCamera, ZoomHasEnds) {
  const render::Camera start = cameras()[0];
  OrbitCamera orbit(start);
  orbit.zoom(1);
  EXPECT_NEAR(distance(orbit.camera()) / distance(start), 0.9, 1e-5);
  orbit.zoom(1e6);
  EXPECT_NEAR(distance(orbit.camera()) / distance(start), 1e-3, 1e-5);
  EXPECT_NE(orbit.camera().eye, orbit.camera().target);
  orbit.zoom(-1e6);
  EXPECT_NEAR(distance(orbit.camera()) / distance(start), 1e3, 1e-2);
}

TEST(OrbitCamera, FarFromTheOriginItStillLooksSomewhere) {
  render::Camera start;
  start.eye = {1e6f, 1e6f, 1e6f + 1};
  start.target = {1e6f, 1e6f, 1e6f};
  OrbitCamera orbit(start);
  orbit.zoom(1000);
  EXPECT_NE(orbit.camera().eye, orbit.camera().target);
}

TEST(OrbitCamera, PansByWhatIsSeen) {
  for (const render::Camera& start : cameras()) {
    OrbitCamera orbit(start);
    orbit.pan(0.25, -0.5);
    const render::Camera moved = orbit.camera();
    const double half = std::tan(0.5 * start.fov_degrees * 3.14159265358979 / 180);
    const auto [right, up] = seen(start, Double3(moved.target));
    EXPECT_NEAR(right / (2 * half), 0.25, 2e-3);
    EXPECT_NEAR(up / (2 * half), -0.5, 2e-3);
    EXPECT_NEAR(distance(moved) / distance(start), 1, 1e-3);
  }
}

}  // namespace
}  // namespace fasttree::live
