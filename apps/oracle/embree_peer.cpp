// SPDX-License-Identifier: Apache-2.0
#include "oracle/embree_peer.h"

#include <string>
#include <utility>

#include "support/large_memory.h"

#if FASTTREE_HAVE_EMBREE

#include <embree3/rtcore.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <new>
#if defined(__SSE3__) || defined(__x86_64__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

namespace fasttree::oracle {
namespace {

constexpr std::size_t kChunk = 256;  // rays

/// Embree's documentation strongly recommends to flush denormal numbers to zero on every thread
/// that traces. Ours to switch on for its sake only, so the thread's mode is put back.
class FlushDenormals {
 public:
#if defined(__SSE3__) || defined(__x86_64__)
  FlushDenormals() : before_(_mm_getcsr()) {
    _mm_setcsr(before_ | 0x8040u);
  }
  ~FlushDenormals() {
    _mm_setcsr(before_);
  }

 private:
  unsigned before_;
#else
  FlushDenormals() {}
  ~FlushDenormals() {}
#endif
 public:
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
};

// Embree has one structure and one function a width. Valid is one int a ray of the packet.
template <int kWidth>
struct Width;

template <>
struct Width<1> {
  using Query = RTCRayHit;
  using Shadow = RTCRay;
  static void trace(const int*, RTCScene s, RTCIntersectContext* c, Query* q) {
    rtcIntersect1(s, c, q);
  }
  static void trace(const int*, RTCScene s, RTCIntersectContext* c, Shadow* q) {
    rtcOccluded1(s, c, q);
  }
};

template <>
struct Width<8> {
  using Query = RTCRayHit8;
  using Shadow = RTCRay8;
  static void trace(const int* valid, RTCScene s, RTCIntersectContext* c, Query* q) {
    rtcIntersect8(valid, s, c, q);
  }
  static void trace(const int* valid, RTCScene s, RTCIntersectContext* c, Shadow* q) {
    rtcOccluded8(valid, s, c, q);
  }
};

template <>
struct Width<16> {
  using Query = RTCRayHit16;
  using Shadow = RTCRay16;
  static void trace(const int* valid, RTCScene s, RTCIntersectContext* c, Query* q) {
    rtcIntersect16(valid, s, c, q);
  }
  static void trace(const int* valid, RTCScene s, RTCIntersectContext* c, Shadow* q) {
    rtcOccluded16(valid, s, c, q);
  }
};

// A packet's field is an array, a single ray's a number.
template <typename T, std::size_t kWidth>
T& lane(T (&values)[kWidth], std::size_t i) {
  return values[i];
}
template <typename T>
T& lane(T& value, std::size_t) {
  return value;
}

template <typename R>
void put_ray(R& r, std::size_t i, const Ray& ray) {
  lane(r.org_x, i) = ray.origin.x;
  lane(r.org_y, i) = ray.origin.y;
  lane(r.org_z, i) = ray.origin.z;
  lane(r.tnear, i) = ray.t_min;
  lane(r.dir_x, i) = ray.direction.x;
  lane(r.dir_y, i) = ray.direction.y;
  lane(r.dir_z, i) = ray.direction.z;
  lane(r.time, i) = 0;
  lane(r.tfar, i) = ray.t_max;
  lane(r.mask, i) = 0xffffffffu;
  lane(r.id, i) = 0;
  lane(r.flags, i) = 0;
}

template <int kWidth>
void put(typename Width<kWidth>::Query& query, std::size_t i, const Ray& ray) {
  put_ray(query.ray, i, ray);
  lane(query.hit.primID, i) = RTC_INVALID_GEOMETRY_ID;
  lane(query.hit.geomID, i) = RTC_INVALID_GEOMETRY_ID;
  lane(query.hit.instID[0], i) = RTC_INVALID_GEOMETRY_ID;
}
template <int kWidth>
void put(typename Width<kWidth>::Shadow& query, std::size_t i, const Ray& ray) {
  put_ray(query, i, ray);
}

template <typename Body>
void parallel_chunks(std::size_t n, std::size_t grain, const Body& body) {
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, n, grain),
                            [&](const auto& range) { body(range.begin(), range.end()); });
}

/// Calls body with the width as a constant.
template <typename Body>
void for_width(int width, const Body& body) {
  switch (width) {
    case 8:
      return body(std::integral_constant<int, 8>());
    case 16:
      return body(std::integral_constant<int, 16>());
    default:
      return body(std::integral_constant<int, 1>());
  }
}

Status embree_error(RTCDevice device, const char* what) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return {};
  const StatusCode code =
      error == RTC_ERROR_OUT_OF_MEMORY ? StatusCode::resource_limit : StatusCode::invalid_argument;
  return {code, std::string("Embree failed while ") + what + " (its error " +
                    std::to_string(static_cast<int>(error)) + "); compare without it"};
}

}  // namespace

struct EmbreeRays::Impl {
  std::byte* memory = nullptr;
  std::size_t capacity = 0;
  std::size_t count = 0;
  int width = 1;
  bool any_hit = false;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { release(); }

  void release() {
    if (memory != nullptr) release_large(memory, capacity);
    memory = nullptr;
    capacity = 0;
  }

  template <typename Packet>
  Packet* packets() const {
    return reinterpret_cast<Packet*>(memory);
  }

  template <int kWidth, typename Packet>
  void set(std::span<const Ray> rays) {
    const std::size_t n = (rays.size() + kWidth - 1) / kWidth;
    if (n * sizeof(Packet) > capacity) {
      release();
      memory = static_cast<std::byte*>(allocate_large(n * sizeof(Packet)));
      capacity = n * sizeof(Packet);
    }
    count = rays.size();
    width = kWidth;
    // What the last packet lacks is a ray that ends before it starts.
    Ray nothing;
    nothing.direction = {0, 0, 1};
    nothing.t_max = -std::numeric_limits<float>::infinity();
    parallel_chunks(n, kChunk / kWidth, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p != end; ++p) {
        Packet* packet = ::new (static_cast<void*>(memory + p * sizeof(Packet))) Packet;
        for (std::size_t i = 0; i < kWidth; ++i) {
          const std::size_t ray = p * kWidth + i;
          put<kWidth>(*packet, i, ray < rays.size() ? rays[ray] : nothing);
        }
      }
    });
  }
};

EmbreeRays::EmbreeRays() : impl_(std::make_unique<Impl>()) {}

void EmbreeRays::set_closest(std::span<const Ray> rays, int width) {
  impl_->any_hit = false;
  for_width(width, [&](auto w) { impl_->set<w(), typename Width<w()>::Query>(rays); });
}

void EmbreeRays::set_occluded(std::span<const Ray> rays, int width) {
  impl_->any_hit = true;
  for_width(width, [&](auto w) { impl_->set<w(), typename Width<w()>::Shadow>(rays); });
}

void EmbreeRays::read(std::span<Hit> hits) const {
  for_width(impl_->width, [&](auto w) {
    constexpr std::size_t kWidth = w();
    const auto* packets = impl_->packets<typename Width<w()>::Query>();
    parallel_chunks(hits.size(), kChunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i != end; ++i) {
        const auto& query = packets[i / kWidth];
        const std::size_t k = i % kWidth;
        hits[i] = Hit();
        if (lane(query.hit.geomID, k) == RTC_INVALID_GEOMETRY_ID) continue;
        hits[i].t = lane(query.ray.tfar, k);
        hits[i].triangle = lane(query.hit.primID, k);
        hits[i].u = lane(query.hit.u, k);
        hits[i].v = lane(query.hit.v, k);
      }
    });
  });
}

void EmbreeRays::read(std::span<std::uint8_t> flags) const {
  for_width(impl_->width, [&](auto w) {
    constexpr std::size_t kWidth = w();
    const auto* packets = impl_->packets<typename Width<w()>::Shadow>();
    for (std::size_t i = 0; i < flags.size(); ++i) {
      // Embree sets tfar to minus infinity at a hit; no ray of ours ends there.
      flags[i] = lane(packets[i / kWidth].tfar, i % kWidth) < 0 ? 1 : 0;
    }
  });
}

struct EmbreePeer::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (geometry != nullptr) rtcReleaseGeometry(geometry);
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  template <int kWidth, typename Packet>
  void trace(EmbreeRays::Impl& rays, bool coherent) const {
    auto* packets = rays.packets<Packet>();
    const std::size_t n = (rays.count + kWidth - 1) / kWidth;
    parallel_chunks(n, kChunk / kWidth, [&](std::size_t begin, std::size_t end) {
      const FlushDenormals flush;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags =
          coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
      alignas(64) int valid[kWidth];
      std::fill_n(valid, kWidth, -1);
      for (std::size_t p = begin; p != end; ++p) {
        if ((p + 1) * kWidth > rays.count) {
          for (std::size_t i = rays.count % kWidth; i < kWidth; ++i) valid[i] = 0;
        }
        Width<kWidth>::trace(valid, scene, &context, packets + p);
      }
    });
  }
};

Result<EmbreePeer> EmbreePeer::create(const MeshView& mesh, EmbreeQuality quality) {
  const RTCBuildQuality asked =
      quality == EmbreeQuality::low ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
  auto impl = std::make_unique<Impl>();
  // Embree starts threads for the whole machine unless it is told.
  const std::string config =
      "threads=" + std::to_string(oneapi::tbb::this_task_arena::max_concurrency());
  impl->device = rtcNewDevice(config.c_str());
  if (Status s = embree_error(impl->device, "starting"); !s.ok()) return s;
  impl->scene = rtcNewScene(impl->device);
  rtcSetSceneFlags(impl->scene, RTC_SCENE_FLAG_DYNAMIC);
  rtcSetSceneBuildQuality(impl->scene, asked);
  if (mesh.triangle_count > 0) {
    RTCGeometry geometry = rtcNewGeometry(impl->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    impl->geometry = geometry;
    rtcSetGeometryBuildQuality(geometry, asked);
    // Buffers of Embree's own: it reads 16 bytes at the last vertex, which a caller's memory need
    // not have.
    auto* positions = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertex_count));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangle_count));
    if (positions == nullptr || indices == nullptr) {
      Status s = embree_error(impl->device, "copying the mesh");
      return s.ok() ? Status(StatusCode::resource_limit, "Embree has no memory for the mesh") : s;
    }
    for (std::uint32_t i = 0; i < mesh.vertex_count; ++i) {
      const Vec3 p = mesh.position(i);
      for (std::size_t a = 0; a < 3; ++a) positions[std::size_t{3} * i + a] = p[a];
    }
    for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        indices[std::size_t{3} * t + c] = mesh.vertex_index(t, c);
      }
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl->scene, geometry);
  }
  rtcCommitScene(impl->scene);
  if (Status s = embree_error(impl->device, "building"); !s.ok()) return s;
  return EmbreePeer(std::move(impl));
}

Status EmbreePeer::rebuild() {
  if (impl_->geometry != nullptr) {
    rtcUpdateGeometryBuffer(impl_->geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(impl_->geometry);
  }
  rtcCommitScene(impl_->scene);
  return embree_error(impl_->device, "building");
}

void EmbreePeer::trace(EmbreeRays& rays, bool coherent) const {
  EmbreeRays::Impl& queries = *rays.impl_;
  for_width(queries.width, [&](auto w) {
    if (queries.any_hit) {
      impl_->trace<w(), typename Width<w()>::Shadow>(queries, coherent);
    } else {
      impl_->trace<w(), typename Width<w()>::Query>(queries, coherent);
    }
  });
}

}  // namespace fasttree::oracle

#else

namespace fasttree::oracle {

// A peer cannot be created here, so what follows is never reached with one.
struct EmbreeRays::Impl {};
struct EmbreePeer::Impl {};

EmbreeRays::EmbreeRays() = default;
void EmbreeRays::set_closest(std::span<const Ray>, int) {}
void EmbreeRays::set_occluded(std::span<const Ray>, int) {}
void EmbreeRays::read(std::span<Hit>) const {}
void EmbreeRays::read(std::span<std::uint8_t>) const {}

Result<EmbreePeer> EmbreePeer::create(const MeshView&, EmbreeQuality) {
  return Status(StatusCode::invalid_argument, "this program was built without Embree");
}
Status EmbreePeer::rebuild() {
  return {};
}
void EmbreePeer::trace(EmbreeRays&, bool) const {}

}  // namespace fasttree::oracle

#endif

namespace fasttree::oracle {

EmbreeRays::EmbreeRays(EmbreeRays&&) noexcept = default;
EmbreeRays& EmbreeRays::operator=(EmbreeRays&&) noexcept = default;
EmbreeRays::~EmbreeRays() = default;

EmbreePeer::EmbreePeer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
EmbreePeer::EmbreePeer(EmbreePeer&&) noexcept = default;
EmbreePeer& EmbreePeer::operator=(EmbreePeer&&) noexcept = default;
EmbreePeer::~EmbreePeer() = default;

}  // namespace fasttree::oracle
