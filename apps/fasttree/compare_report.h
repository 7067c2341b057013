// SPDX-License-Identifier: Apache-2.0
// A comparison as text, CSV, SVG and JSON.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "contender.h"
#include "figures.h"
#include "output.h"
#include "render/camera.h"

namespace fasttree::app {

/// All that is to be said.
struct Comparison {
  std::string scene;   ///< its name
  std::string source;  ///< what --scene was given
  std::uint32_t triangles = 0;
  int threads = 0;
  std::uint32_t rounds = 0;  ///< counted ones
  std::uint32_t width = 0, height = 0;
  render::Camera camera;
  Vec3 light;
  RayCounts counts{};
  std::vector<Record> records;   ///< trees first
  std::vector<Figures> figures;  ///< of the records
  HeadToHead duel;
  std::string no_embree;  ///< why no Embree takes part; empty where one does
  std::string wrong;      ///< which tree's hits differ; empty where none's do
};

void print(Output& output, const Comparison& comparison);
std::string csv_of(const Comparison& comparison);
std::string svg_of(const Comparison& comparison);
nlohmann::ordered_json json_of(const Comparison& comparison);

}  // namespace fasttree::app
