// SPDX-License-Identifier: Apache-2.0
#include "scene/procedural/procedural.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <new>
#include <numeric>
#include <string_view>
#include <vector>

#include "scene/procedural/scenes.h"
#include "scene/scene.h"

namespace fasttree::scene {

namespace {

constexpr std::string_view kPrefix = "scene:";
constexpr std::uint32_t kLoop = 24;

using Planner = void (*)(const Request&, Plan&);

constexpr std::array kScenes{
    ProceduralInfo{"knot", "a fluted tube tied into a torus knot: one curved surface", 200'000, 1,
                   false},
    ProceduralInfo{"hall", "a vaulted hall with columns, arches and windows, seen from inside",
                   250'000, 1, true},
    ProceduralInfo{"stadium",
                   "a knot 1.5 m high, nine tenths of the triangles, in a stadium of 200 m",
                   200'000, 1, false},
    ProceduralInfo{"spheres", "a sphere flake: spheres on spheres on spheres", 200'000, 1, false},
    ProceduralInfo{"cloud", "small random triangles spread evenly over a cube", 100'000, 1, false},
    ProceduralInfo{"terrain", "eroded mountains: a height field", 200'000, 1, false},
    ProceduralInfo{"wave", "a rolling sea, moving: a loop of 24 frames", 100'000, kLoop, false},
    ProceduralInfo{"breakup", "a knot that falls apart into its triangles and heals: 24 frames",
                   100'000, kLoop, false},
};

constexpr std::array<Planner, kScenes.size()> kPlanners{plan_knot,    plan_hall,   plan_stadium,
                                                        plan_spheres, plan_cloud,  plan_terrain,
                                                        plan_wave,    plan_breakup};

// Levenshtein's distance, for the name that was probably meant.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

Status unknown_name(std::string_view name) {
  std::string list;
  const ProceduralInfo* nearest = nullptr;
  std::size_t nearest_distance = 0;
  for (const ProceduralInfo& scene : kScenes) {
    list += (list.empty() ? "" : ", ") + std::string(scene.name);
    const std::size_t distance = edit_distance(name.substr(0, 64), scene.name);
    if (nearest == nullptr || distance < nearest_distance) {
      nearest = &scene;
      nearest_distance = distance;
    }
  }
  return Status(StatusCode::invalid_argument,
                "no procedural scene is called '" + std::string(name.substr(0, 64)) +
                    "'; nearest: scene:" + nearest->name + "; there are: " + list);
}

// Digits, and k or M behind them for thousands and millions where `suffixes`. False: not a number
// or larger than `limit`.
bool parse_count(std::string_view text, bool suffixes, std::uint64_t limit, std::uint64_t& value) {
  std::uint64_t factor = 1;
  if (suffixes && !text.empty() && (text.back() == 'k' || text.back() == 'M')) {
    factor = text.back() == 'k' ? 1'000 : 1'000'000;
    text.remove_suffix(1);
  }
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || value > limit / factor) return false;
  value *= factor;
  return true;
}

}  // namespace

std::span<const ProceduralInfo> procedural_scenes() {
  return kScenes;
}

Result<Mesh> make_procedural_scene(const std::string& spec, const LoadSettings& settings) {
  const auto bad = [&](const std::string& what) {
    return Status(StatusCode::invalid_argument,
                  std::string("'") + spec.substr(0, 128) + "': " + what +
                      "; write scene:NAME[:TRIANGLES[:FRAME]], as in scene:knot:50k");
  };
  std::string_view rest = spec;
  if (!rest.starts_with(kPrefix)) return bad("a procedural scene begins with scene:");
  rest.remove_prefix(kPrefix.size());
  std::array<std::string_view, 3> fields;
  std::size_t count = 0;
  for (bool more = true; more; ++count) {
    if (count == fields.size()) return bad("too many fields");
    const std::size_t colon = rest.find(':');
    more = colon != std::string_view::npos;
    fields[count] = rest.substr(0, colon);
    if (more) rest.remove_prefix(colon + 1);
  }

  const auto scene = std::find_if(kScenes.begin(), kScenes.end(),
                                  [&](const ProceduralInfo& s) { return fields[0] == s.name; });
  if (scene == kScenes.end()) return unknown_name(fields[0]);

  Request request;
  request.triangles = scene->default_triangles;
  if (!fields[1].empty() &&
      (!parse_count(fields[1], true, kMaxProceduralTriangles, request.triangles) ||
       request.triangles == 0)) {
    return bad("the number of triangles has to be 1 to " + std::to_string(kMaxProceduralTriangles));
  }
  if (count == 3) {
    if (scene->frames == 1) return bad("this scene does not move, leave the frame out");
    std::uint64_t frame = 0;
    if (!parse_count(fields[2], false, 0xffffffffu, frame))
      return bad("the frame has to be a number from 0 on");
    request.phase = static_cast<double>(frame % scene->frames) / scene->frames;
  }

  try {
    Plan plan;
    kPlanners[static_cast<std::size_t>(scene - kScenes.begin())](request, plan);
    return plan.make(scene->name, settings);
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::resource_limit,
                  "out of memory while planning " + spec + "; ask for fewer triangles");
  }
}

}  // namespace fasttree::scene
