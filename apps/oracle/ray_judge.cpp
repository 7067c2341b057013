// SPDX-License-Identifier: Apache-2.0
#include "oracle/ray_judge.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <optional>
#include <utility>

#include "oracle/embree_oracle.h"

namespace fasttree::oracle {
namespace {

constexpr std::size_t kBlock = 1024;  // rays between two looks at the progress callback

bool same(const Hit& a, const Hit& b) {
  return a.triangle == b.triangle &&
         std::bit_cast<std::uint32_t>(a.t) == std::bit_cast<std::uint32_t>(b.t) &&
         std::bit_cast<std::uint32_t>(a.u) == std::bit_cast<std::uint32_t>(b.u) &&
         std::bit_cast<std::uint32_t>(a.v) == std::bit_cast<std::uint32_t>(b.v);
}

bool nearer(const Hit& a, const Hit& b) {
  return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
}

/// The hit of one triangle alone, by the library's routine.
Hit hit_of(const MeshView& mesh, std::uint32_t triangle, const Ray& ray) {
  const std::array<std::uint32_t, 3> indices = {mesh.vertex_index(triangle, 0),
                                                mesh.vertex_index(triangle, 1),
                                                mesh.vertex_index(triangle, 2)};
  MeshView one = mesh;
  one.indices = indices.data();
  one.triangle_count = 1;
  Hit hit = brute_force_closest(one, ray);
  if (hit.hit()) hit.triangle = triangle;
  return hit;
}

std::string describe(const Hit& hit) {
  if (!hit.hit()) return "a miss";
  char text[96];
  std::snprintf(text, sizeof text, "triangle %u at t = %.9g", hit.triangle,
                static_cast<double>(hit.t));
  return text;
}

std::string describe(const Ray& ray) {
  // Hexadecimal floats: the ray can be rebuilt to the bit from the message.
  const auto f = [](float x) { return static_cast<double>(x); };
  char text[256];
  std::snprintf(text, sizeof text, "origin (%a %a %a), direction (%a %a %a), t %a to %a",
                f(ray.origin.x), f(ray.origin.y), f(ray.origin.z), f(ray.direction.x),
                f(ray.direction.y), f(ray.direction.z), f(ray.t_min), f(ray.t_max));
  return text;
}

/// What came of one ray.
struct Verdict {
  bool hit = false;
  bool brute = false;
  bool settled = false;
  std::string wrong;  ///< empty: right
};

class Judge {
 public:
  Judge(const MeshView& mesh, const Tree& tree, const EmbreeScene* embree)
      : mesh_(mesh), brute_force_(mesh), embree_(embree) {
    const Vec3 half = tree.info().bounds.hi * 0.5f - tree.info().bounds.lo * 0.5f;
    size_ = 2.0f * std::max({half.x, half.y, half.z});
  }

  /// `found` by the tracer; `blocked` is its any-hit answer.
  Verdict judge(const Ray& ray, const Hit& found, bool blocked) const {
    Verdict verdict;
    verdict.hit = found.hit();
    if (blocked != found.hit()) {
      verdict.wrong = "any hit says " + std::string(blocked ? "hit" : "miss") + ", closest hit " +
                      describe(found);
      return verdict;
    }
    if (embree_ == nullptr || !EmbreeScene::accepts(ray)) {
      against_brute_force(ray, found, verdict);
      return verdict;
    }
    against_embree(ray, found, verdict);
    return verdict;
  }

 private:
  void against_brute_force(const Ray& ray, const Hit& found, Verdict& verdict) const {
    verdict.brute = true;
    const Hit expected = brute_force_.closest(ray);
    if (!same(found, expected)) {
      verdict.wrong = "the tree gives " + describe(found) + ", brute force " + describe(expected);
    }
  }

  void against_embree(const Ray& ray, const Hit& found, Verdict& verdict) const {
    if (found.hit()) {
      const Hit alone = hit_of(mesh_, found.triangle, ray);
      if (!same(alone, found)) {
        verdict.wrong =
            "the tree gives " + describe(found) + ", that triangle alone " + describe(alone);
        return;
      }
    }
    const Hit theirs = embree_->closest(ray);
    if (theirs.hit() && theirs.triangle != found.triangle) {
      const Hit alone = hit_of(mesh_, theirs.triangle, ray);
      if (alone.hit() && nearer(alone, found)) {
        verdict.wrong = "the tree gives " + describe(found) + ", nearer is " + describe(alone);
        return;
      }
    }
    if (theirs.hit() == found.hit() && (!found.hit() || close(ray, found.t, theirs.t))) return;
    against_brute_force(ray, found, verdict);
    verdict.settled = verdict.wrong.empty();
  }

  bool close(const Ray& ray, float a, float b) const {
    const double length =
        std::hypot(static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                   static_cast<double>(ray.direction.z));
    const double slack =
        1e-4 * std::max(std::abs(static_cast<double>(a)), std::abs(static_cast<double>(b))) +
        (length > 0 ? 1e-5 * static_cast<double>(size_) / length : 0);
    return std::abs(static_cast<double>(a) - static_cast<double>(b)) <= slack;
  }

  MeshView mesh_;
  BruteForce brute_force_;
  const EmbreeScene* embree_;
  float size_ = 0;
};

/// Counts of one set, and the wrong ray with the lowest number.
class Tally {
 public:
  void add(std::uint64_t number, const Ray& ray, const Verdict& verdict) {
    hits_ += verdict.hit;
    brute_ += verdict.brute;
    settled_ += verdict.settled;
    if (verdict.wrong.empty()) return;
    ++wrong_;
    const std::lock_guard lock(mutex_);
    if (first_ && first_->first <= number) return;
    first_.emplace(number, verdict.wrong + "; the ray: " + describe(ray));
  }

  SetReport report(RaySet set, std::uint64_t rays) const {
    return {set, rays, hits_.load(), brute_.load(), settled_.load(), wrong_.load()};
  }
  const std::optional<std::pair<std::uint64_t, std::string>>& first() const { return first_; }

 private:
  std::atomic<std::uint64_t> hits_{0}, brute_{0}, settled_{0}, wrong_{0};
  std::mutex mutex_;
  std::optional<std::pair<std::uint64_t, std::string>> first_;
};

}  // namespace

const char* to_string(Oracle oracle) {
  return oracle == Oracle::brute ? "brute" : "embree";
}

SetReport RayReport::total() const {
  SetReport sum;
  for (const SetReport& s : sets) {
    sum.rays += s.rays;
    sum.hits += s.hits;
    sum.brute_checked += s.brute_checked;
    sum.settled += s.settled;
    sum.wrong += s.wrong;
  }
  return sum;
}

Result<RayReport> judge_rays(const MeshView& mesh, const Tree& tree, const Tracer& tracer,
                             const JudgeSettings& settings) {
  std::optional<EmbreeScene> embree;
  if (settings.oracle == Oracle::embree) {
    auto scene = EmbreeScene::create(mesh);
    if (!scene.ok()) return scene.status();
    embree.emplace(std::move(scene).value());
  }
  const Judge judge(mesh, tree, embree ? &*embree : nullptr);
  const RayGenerator generator(mesh, tree, settings.seed);

  RayReport report;
  report.oracle = settings.oracle;
  std::vector<Ray> rays(kBlock);
  std::vector<Hit> hits(kBlock);
  std::vector<std::uint8_t> blocked(kBlock);
  std::uint64_t done = 0;
  for (std::size_t s = 0; s < kAllRaySets.size(); ++s) {
    const RaySet set = kAllRaySets[s];
    const std::uint64_t count =
        settings.rays / kAllRaySets.size() + (s < settings.rays % kAllRaySets.size() ? 1 : 0);
    Tally tally;
    for (std::uint64_t first = 0; first < count; first += kBlock) {
      if (settings.progress && !settings.progress("rays", static_cast<double>(done) /
                                                              static_cast<double>(settings.rays))) {
        return Status(StatusCode::cancelled, "cancelled while tracing rays");
      }
      const std::size_t n = std::min<std::uint64_t>(kBlock, count - first);
      const std::span block(rays.data(), n);
      generator.generate(set, first, block);
      // The batch calls are under test as well as the single ones.
      tracer.closest(block, std::span(hits.data(), n));
      tracer.occluded(block, std::span(blocked.data(), n));
      oneapi::tbb::parallel_for(
          oneapi::tbb::blocked_range<std::size_t>(0, n, 8), [&](const auto& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
              const Hit found = tracer.closest(rays[i]);
              const bool any = tracer.occluded(rays[i]);
              Verdict verdict;
              if (!same(found, hits[i]) || any != (blocked[i] != 0)) {
                verdict.hit = found.hit();
                verdict.wrong =
                    "one by one " + describe(found) + ", in a batch " + describe(hits[i]);
              } else {
                verdict = judge.judge(rays[i], found, any);
              }
              tally.add(first + i, rays[i], verdict);
            }
          });
      done += n;
    }
    report.sets.push_back(tally.report(set, count));
    if (report.first_wrong.empty() && tally.first()) {
      report.first_wrong = std::string("ray ") + std::to_string(tally.first()->first) + " of set " +
                           to_string(set) + ": " + tally.first()->second;
    }
  }
  if (settings.progress && !settings.progress("rays", 1.0)) {
    return Status(StatusCode::cancelled, "cancelled while tracing rays");
  }
  return report;
}

}  // namespace fasttree::oracle
