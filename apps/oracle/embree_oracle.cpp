// SPDX-License-Identifier: Apache-2.0
#include "oracle/embree_oracle.h"

#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#if FASTTREE_HAVE_EMBREE

#include <embree3/rtcore.h>
#include <oneapi/tbb/task_arena.h>

namespace fasttree::oracle {

bool embree_available() {
  return true;
}

const char* embree_version() {
  return RTC_VERSION_STRING;
}

struct EmbreeScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  double build_ms = 0;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

namespace {

Status embree_error(RTCDevice device, const char* what) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return {};
  const StatusCode code =
      error == RTC_ERROR_OUT_OF_MEMORY ? StatusCode::resource_limit : StatusCode::invalid_argument;
  return {code, std::string("Embree failed while ") + what + " (its error " +
                    std::to_string(static_cast<int>(error)) + "); use brute force as the oracle"};
}

RTCRay embree_ray(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.tnear = ray.t_min;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tfar = ray.t_max;
  r.mask = 0xffffffffu;
  return r;
}

}  // namespace

Result<EmbreeScene> EmbreeScene::create(const MeshView& mesh, bool fast) {
  const auto start = std::chrono::steady_clock::now();
  auto impl = std::make_unique<Impl>();
  // Embree starts threads for the whole machine unless it is told.
  const std::string config =
      "threads=" + std::to_string(oneapi::tbb::this_task_arena::max_concurrency());
  impl->device = rtcNewDevice(config.c_str());
  if (Status s = embree_error(impl->device, "starting"); !s.ok()) return s;
  impl->scene = rtcNewScene(impl->device);
  rtcSetSceneFlags(impl->scene, fast ? RTC_SCENE_FLAG_NONE : RTC_SCENE_FLAG_ROBUST);
  if (mesh.triangle_count > 0) {
    RTCGeometry geometry = rtcNewGeometry(impl->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Buffers of Embree's own: it reads 16 bytes at the last vertex, which a caller's memory need
    // not have.
    auto* positions = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertex_count));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangle_count));
    if (positions == nullptr || indices == nullptr) {
      rtcReleaseGeometry(geometry);
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
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(impl->scene);
  if (Status s = embree_error(impl->device, "building"); !s.ok()) return s;
  impl->build_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return EmbreeScene(std::move(impl));
}

Hit EmbreeScene::closest(const Ray& ray) const {
  Hit hit;
  if (!accepts(ray)) return hit;
  RTCRayHit query{};
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.primID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.t = query.ray.tfar;
  hit.triangle = query.hit.primID;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  return hit;
}

bool EmbreeScene::occluded(const Ray& ray) const {
  if (!accepts(ray)) return false;
  RTCRay query = embree_ray(ray);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &query);
  return query.tfar < ray.t_max;  // Embree sets tfar to minus infinity at a hit
}

double EmbreeScene::build_ms() const {
  return impl_->build_ms;
}

}  // namespace fasttree::oracle

#else

namespace fasttree::oracle {

bool embree_available() {
  return false;
}

const char* embree_version() {
  return "not found";
}

struct EmbreeScene::Impl {};

Result<EmbreeScene> EmbreeScene::create(const MeshView&, bool) {
  return Status(StatusCode::invalid_argument,
                "this program was built without Embree; use brute force as the oracle");
}

// A scene cannot be created here, so these are never reached with one.
Hit EmbreeScene::closest(const Ray&) const {
  return {};
}
bool EmbreeScene::occluded(const Ray&) const {
  return false;
}
double EmbreeScene::build_ms() const {
  return 0;
}

}  // namespace fasttree::oracle

#endif

namespace fasttree::oracle {

// Builds of Embree with assertions abort at such rays, the others give anything.
bool EmbreeScene::accepts(const Ray& ray) {
  constexpr float kLargest = 1.8e18f;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(std::fabs(ray.origin[a]) <= kLargest && std::fabs(ray.direction[a]) <= kLargest)) {
      return false;
    }
  }
  return ray.t_min >= 0.0f && ray.t_max >= 0.0f;
}

EmbreeScene::EmbreeScene(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
EmbreeScene::EmbreeScene(EmbreeScene&&) noexcept = default;
EmbreeScene& EmbreeScene::operator=(EmbreeScene&&) noexcept = default;
EmbreeScene::~EmbreeScene() = default;

}  // namespace fasttree::oracle
