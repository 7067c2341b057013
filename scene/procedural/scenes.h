// SPDX-License-Identifier: Apache-2.0
// The planners behind the names; procedural.cpp lists them.
#pragma once

#include <cstdint>

#include "scene/procedural/patch.h"

namespace fasttree::scene {

/// What was asked for. `phase` is the place in an animation's loop, 0 (inclusive) to 1.
struct Request {
  std::uint64_t triangles = 0;
  double phase = 0;
};

void plan_knot(const Request& request, Plan& plan);
void plan_hall(const Request& request, Plan& plan);
void plan_stadium(const Request& request, Plan& plan);
void plan_spheres(const Request& request, Plan& plan);
void plan_cloud(const Request& request, Plan& plan);
void plan_terrain(const Request& request, Plan& plan);
void plan_wave(const Request& request, Plan& plan);
void plan_breakup(const Request& request, Plan& plan);

}  // namespace fasttree::scene
