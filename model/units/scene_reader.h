// SPDX-License-Identifier: Apache-2.0
// Brings the triangles in from memory: coordinates by axis to the SBCUs in step 1, whole triangles
// to the MCGUs, in turn, in step 2.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/config/paper_config.h"
#include "model/kernel/queue.h"
#include "model/kernel/unit.h"
#include "model/system/stream.h"

namespace fasttree::model {

inline constexpr std::uint32_t kTriangleBytes = 36;  ///< nine binary32
inline constexpr std::uint32_t kMaxBoundInputs = 16;

/// Coordinates of one axis, as many as an SBCU selects from at once.
struct CoordinateGroup {
  std::uint32_t axis = 0;
  std::array<float, kMaxBoundInputs> values{};
};

struct TriangleJob {
  std::uint32_t id = 0;
  std::array<float, 9> coordinates{};  ///< x, y, z of each corner
};

class SceneReader : public Unit {
 public:
  SceneReader(const PaperConfig& config, BusPort& port);

  /// Step 1. Every group goes to all of `units`.
  void start_bounds(Address scene, std::uint32_t triangles,
                    std::vector<Queue<CoordinateGroup>*> units);
  /// Step 2. Triangle t goes to unit t modulo their number.
  void start_triangles(Address scene, std::uint32_t triangles,
                       std::vector<Queue<TriangleJob>*> units);

  void tick() override;
  bool done() const override;
  std::string waits_for() const override;

 private:
  struct Gather {
    std::uint32_t count = 0;
    std::array<float, 2 * kMaxBoundInputs> values{};
  };
  bool gather_coordinates();
  bool send_group();
  bool take_bytes();
  bool send_triangle();

  PaperConfig config_;
  StreamReader reader_;
  std::vector<Queue<CoordinateGroup>*> bound_units_;
  std::vector<Queue<TriangleJob>*> code_units_;
  bool bounds_ = true;
  bool blocked_ = false;  ///< by the units behind
  std::uint32_t next_axis_ = 0;
  std::array<Gather, 3> gathers_;
  std::array<std::uint8_t, kTriangleBytes + kMaxRequestBytes> held_{};
  std::uint32_t held_bytes_ = 0;
  std::uint32_t next_triangle_ = 0;
  std::size_t next_unit_ = 0;
};

}  // namespace fasttree::model
