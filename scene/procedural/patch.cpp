// SPDX-License-Identifier: Apache-2.0
#include "scene/procedural/patch.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <new>

namespace fasttree::scene {

namespace {

Vec3 rounded(Point p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

// Writes patches and soups one behind the other into arrays of the final size, rows in parallel:
// every element's place is known beforehand, so threads never meet.
class Writer {
 public:
  /// `work`: vertices and triangles of the whole scene, for the progress.
  Writer(Mesh& mesh, std::uint64_t work, const ProgressCallback& progress)
      : mesh_(mesh), work_(work), progress_(progress) {}

  bool write(const Patch& patch);
  bool write(const Soup& soup);

 private:
  template <typename Body>
  bool rows(std::uint64_t count, std::uint64_t work_a_row, const Body& body);

  Mesh& mesh_;
  std::uint64_t work_;
  const ProgressCallback& progress_;
  std::uint64_t first_vertex_ = 0;
  std::uint64_t first_triangle_ = 0;
  std::uint64_t done_ = 0;
  std::uint64_t reported_ = 0;
};

// In blocks, so that the callback runs on this thread and often enough. False: cancelled.
template <typename Body>
bool Writer::rows(std::uint64_t count, std::uint64_t work_a_row, const Body& body) {
  constexpr std::uint64_t kBlock = std::uint64_t{1} << 18;
  constexpr std::uint64_t kTask = std::uint64_t{1} << 12;
  const std::uint64_t step = std::max<std::uint64_t>(kBlock / work_a_row, 1);
  const std::uint64_t grain = std::max<std::uint64_t>(kTask / work_a_row, 1);
  for (std::uint64_t begin = 0; begin < count; begin += step) {
    const std::uint64_t end = std::min(begin + step, count);
    if ((end - begin) * work_a_row < 2 * kTask) {
      // Scenes of many small patches: not worth waking threads for each.
      for (std::uint64_t row = begin; row < end; ++row) body(row);
    } else {
      tbb::parallel_for(tbb::blocked_range<std::uint64_t>(begin, end, grain),
                        [&](const tbb::blocked_range<std::uint64_t>& range) {
                          for (std::uint64_t row = range.begin(); row < range.end(); ++row)
                            body(row);
                        });
    }
    done_ += (end - begin) * work_a_row;
    if (progress_ && done_ - reported_ >= kBlock) {
      reported_ = done_;
      const double fraction = static_cast<double>(done_) / static_cast<double>(work_);
      if (!progress_("procedural scene", std::min(fraction, 1.0))) return false;
    }
  }
  return true;
}

bool Writer::write(const Patch& p) {
  // Vertex rows from v = 0 on: a pole's row is one vertex, the last row is missing where v wraps.
  const std::uint64_t columns = p.nu + (p.wrap_u ? 0u : 1u);
  const std::uint64_t vertex_rows = p.nv + (p.wrap_v ? 0u : 1u);
  const auto row_start = [&](std::uint64_t row) {
    return first_vertex_ + (p.pole_lo && row > 0 ? (row - 1) * columns + 1 : row * columns);
  };
  const auto is_pole = [&](std::uint64_t row) {
    return (p.pole_lo && row == 0) || (p.pole_hi && row == p.nv);
  };
  const bool vertices_done = rows(vertex_rows, columns, [&](std::uint64_t row) {
    const double v = static_cast<double>(row) / p.nv;
    Vec3* out = mesh_.positions.data() + row_start(row);
    const std::uint64_t count = is_pole(row) ? 1 : columns;
    for (std::uint64_t i = 0; i < count; ++i)
      out[i] = rounded(p.at(static_cast<double>(i) / p.nu, v));
  });
  if (!vertices_done) return false;

  const auto vertex = [&](std::uint64_t column, std::uint64_t row) {
    const std::uint64_t r = p.wrap_v && row == p.nv ? 0 : row;
    const std::uint64_t c = is_pole(r) || (p.wrap_u && column == p.nu) ? 0 : column;
    return static_cast<std::uint32_t>(row_start(r) + c);
  };
  const auto triangle_start = [&](std::uint64_t row) {
    return first_triangle_ + 2 * row * p.nu - (p.pole_lo && row > 0 ? p.nu : 0);
  };
  const bool triangles_done = rows(p.nv, 2 * std::uint64_t{p.nu}, [&](std::uint64_t row) {
    std::uint32_t* out = mesh_.indices.data() + 3 * triangle_start(row);
    for (std::uint64_t i = 0; i < p.nu; ++i) {
      const std::uint32_t a = vertex(i, row), b = vertex(i + 1, row);
      const std::uint32_t c = vertex(i + 1, row + 1), d = vertex(i, row + 1);
      if (!is_pole(row)) {
        *out++ = a;
        *out++ = b;
        *out++ = c;
      }
      if (!is_pole(row + 1)) {
        *out++ = a;
        *out++ = c;
        *out++ = d;
      }
    }
  });
  first_vertex_ += p.vertices();
  first_triangle_ += p.triangles();
  return triangles_done;
}

bool Writer::write(const Soup& soup) {
  const bool done = rows(soup.count, 4, [&](std::uint64_t i) {
    const std::array<Point, 3> corners = soup.at(i);
    for (std::uint64_t k = 0; k < 3; ++k) {
      mesh_.positions[first_vertex_ + 3 * i + k] = rounded(corners[k]);
      mesh_.indices[3 * (first_triangle_ + i) + k] =
          static_cast<std::uint32_t>(first_vertex_ + 3 * i + k);
    }
  });
  first_vertex_ += 3 * soup.count;
  first_triangle_ += soup.count;
  return done;
}

}  // namespace

std::uint64_t Patch::triangles() const {
  return std::uint64_t{nu} * (2 * std::uint64_t{nv} - (pole_lo ? 1 : 0) - (pole_hi ? 1 : 0));
}

std::uint64_t Patch::vertices() const {
  const std::uint64_t columns = nu + (wrap_u ? 0u : 1u);
  const std::uint64_t rows = nv + (wrap_v ? 0u : 1u);
  const std::uint64_t poles = (pole_lo ? 1u : 0u) + (pole_hi ? 1u : 0u);
  return (rows - poles) * columns + poles;
}

void set_resolution(Patch& patch, const Share& share, double triangles) {
  // Poles take a row's half away; add it before the grid is chosen.
  const double poles = (patch.pole_lo ? 1.0 : 0.0) + (patch.pole_hi ? 1.0 : 0.0);
  const double step = std::max(share.step_nv, 1u);
  double nv = std::sqrt(triangles / (2 * share.aspect)) + 0.25 * poles;
  nv = step * std::max(std::round(nv / step), 1.0);
  nv = std::max(nv, static_cast<double>(std::max(share.min_nv, poles == 2 ? 2u : 1u)));
  double nu = std::round(triangles / (2 * nv - poles));
  nu = std::max(nu, static_cast<double>(std::max(share.min_nu, 1u)));
  patch.nv = static_cast<std::uint32_t>(nv);
  patch.nu = static_cast<std::uint32_t>(nu);
}

void Plan::distribute(std::uint64_t triangles) {
  double left = static_cast<double>(triangles);
  for (const Patch& p : fixed_) left -= static_cast<double>(p.triangles());
  for (const Soup& s : soups_) left -= static_cast<double>(s.count);
  double weights = 0;
  for (const auto& [patch, share] : shared_) weights += share.weight;
  for (auto& [patch, share] : shared_) {
    set_resolution(patch, share, std::max(left, 0.0) * share.weight / weights);
    left -= static_cast<double>(patch.triangles());
    weights -= share.weight;
  }
}

std::uint64_t Plan::triangles() const {
  std::uint64_t sum = 0;
  for (const Patch& p : fixed_) sum += p.triangles();
  for (const auto& [patch, share] : shared_) sum += patch.triangles();
  for (const Soup& s : soups_) sum += s.count;
  return sum;
}

std::uint64_t Plan::vertices() const {
  std::uint64_t sum = 0;
  for (const Patch& p : fixed_) sum += p.vertices();
  for (const auto& [patch, share] : shared_) sum += patch.vertices();
  for (const Soup& s : soups_) sum += 3 * s.count;
  return sum;
}

Result<Mesh> Plan::make(std::string name, const LoadSettings& settings) const {
  const std::uint64_t triangle_total = triangles();
  const std::uint64_t vertex_total = vertices();
  const std::uint64_t bytes =
      vertex_total * sizeof(Vec3) + triangle_total * 3 * sizeof(std::uint32_t);
  if (settings.memory_limit_bytes != 0 && bytes > settings.memory_limit_bytes) {
    return Status(StatusCode::resource_limit,
                  "scene:" + name + " with " + std::to_string(triangle_total) +
                      " triangles takes " + std::to_string(bytes) + " bytes, the memory limit is " +
                      std::to_string(settings.memory_limit_bytes) +
                      "; ask for fewer triangles or raise the limit");
  }
  if (vertex_total > std::numeric_limits<std::uint32_t>::max() || triangle_total > kMaxTriangles) {
    return Status(StatusCode::resource_limit, "scene:" + name + " with " +
                                                  std::to_string(triangle_total) +
                                                  " triangles is too large for 32-bit indices; "
                                                  "ask for fewer triangles");
  }

  Mesh mesh;
  mesh.name = std::move(name);
  try {
    mesh.positions.resize(vertex_total);
    mesh.indices.resize(3 * triangle_total);
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::resource_limit, "scene:" + mesh.name + " needs " +
                                                  std::to_string(bytes) +
                                                  " bytes, which the system does not give; ask "
                                                  "for fewer triangles");
  }
  Writer writer(mesh, vertex_total + triangle_total, settings.progress);
  const auto write_all = [&] {
    for (const Patch& p : fixed_)
      if (!writer.write(p)) return false;
    for (const auto& [patch, share] : shared_)
      if (!writer.write(patch)) return false;
    for (const Soup& s : soups_)
      if (!writer.write(s)) return false;
    return true;
  };
  if (!write_all())
    return Status(StatusCode::cancelled, "cancelled while making scene:" + mesh.name);
  return mesh;
}

}  // namespace fasttree::scene
