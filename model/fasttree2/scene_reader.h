// SPDX-License-Identifier: Apache-2.0
// Streams the scene from memory: beats in, a triangle of nine floats a cycle out, to the scene's
// bounds, to the generation of records, or to both.
#pragma once

#include <array>
#include <cstdint>

#include "model/fasttree2/dma.h"
#include "model/fasttree2/registers.h"
#include "model/kernel/queue.h"

namespace fasttree::model::ft2 {

struct SceneTriangle {
  std::uint32_t id = 0;
  std::array<float, 9> v{};  ///< x, y, z of each corner
};
inline constexpr std::uint32_t kTriangleBytes = 36;

class SceneReader : public Unit {
 public:
  SceneReader(Registers& registers, Dma& dma, Queue<SceneTriangle>& to_bounds,
              Queue<SceneTriangle>& to_codes);

  /// Starts a pass over the scene.
  void begin(bool to_bounds, bool to_codes);

  /// The triangles that are left go to the bounds alone.
  void bounds_only() { to_codes_ = false; }

  void tick() override;
  bool done() const override { return sent_ == r_.triangles; }
  std::string waits_for() const override;
  std::uint32_t sent() const { return sent_; }
  double fraction() const { return r_.triangles ? double(sent_) / r_.triangles : 1.0; }

 private:
  Registers& r_;
  ReadPort& port_;
  Queue<SceneTriangle>& bounds_queue_;
  Queue<SceneTriangle>& codes_queue_;
  bool to_bounds_ = false;
  bool to_codes_ = false;
  std::uint64_t bytes_ = 0;      ///< of the whole scene
  std::uint64_t requested_ = 0;  ///< bytes
  std::uint64_t beats_requested_ = 0;
  std::uint32_t sent_ = 0;  ///< triangles
  std::array<std::uint8_t, kTriangleBytes + kMaxBeatBytes> gathered_{};
  std::uint32_t held_ = 0;
};

}  // namespace fasttree::model::ft2
