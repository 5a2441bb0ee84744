#ifndef ORBIFIT_PORTABLE

#include <cstdint>
#include <mutex>
#include <new>
#include <numeric>
#include <string>

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include "orbifit/model/errors.h"

#include "geometry/face_tree.h"

namespace orbifit {

namespace {

using Device = std::shared_ptr<RTCDeviceTy>;

// One device serves all indices for as long as one lives. Threads are not limited here: Embree would limit all that the
// process has.
Device shared_device() {
  static std::mutex mutex;
  static std::weak_ptr<RTCDeviceTy> current;
  const std::lock_guard lock(mutex);
  Device device = current.lock();
  if (!device) {
    device = Device(rtcNewDevice("set_affinity=0"), [](RTCDevice handle) {
      if (handle != nullptr) rtcReleaseDevice(handle);
    });
    if (!device) throw std::bad_alloc();  // for threads or their stacks; nothing else is ever missing
    current = device;
  }
  return device;
}

struct Measured {
  MeasureFace measure;
  void* search;
};

bool measure_face(RTCPointQueryFunctionArguments* arguments) {
  const Measured& measured = *static_cast<const Measured*>(arguments->userPtr);
  return measured.measure(measured.search, arguments->primID, arguments->query->radius);
}

RTCRay to_embree(const TreeRay& ray) {
  RTCRay result{};
  result.org_x = ray.origin.x();
  result.org_y = ray.origin.y();
  result.org_z = ray.origin.z();
  result.dir_x = ray.direction.x();
  result.dir_y = ray.direction.y();
  result.dir_z = ray.direction.z();
  result.tnear = ray.near;
  result.tfar = ray.far;
  result.mask = 0xFFFFFFFFU;
  return result;
}

}  // namespace

struct EmbreeTree::Implementation {
  Device device = shared_device();
  RTCScene scene = nullptr;

  ~Implementation() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }
};

EmbreeTree::EmbreeTree(const std::vector<TreeFace>& faces) : implementation_(std::make_unique<Implementation>()) {
  RTCDevice device = implementation_->device.get();
  RTCScene& scene = implementation_->scene;
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                3 * sizeof(float), 3 * faces.size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), faces.size()));
  if (positions == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw Error("Embree cannot hold " + std::to_string(faces.size()) + " faces");
  }
  for (const TreeFace& face : faces) {
    for (const Eigen::Vector3f& corner : face) positions = std::copy_n(corner.data(), 3, positions);
  }
  std::iota(indices, indices + 3 * faces.size(), 0U);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);  // the scene keeps it
  tbb::task_arena alone(1);      // Embree builds on the threads of the arena that it is called in
  alone.execute([&] { rtcCommitScene(scene); });
}

EmbreeTree::~EmbreeTree() = default;

void EmbreeTree::search(const Eigen::Vector3f& point, float radius, MeasureFace measure, void* search) const {
  RTCPointQuery query{};
  query.x = point.x();
  query.y = point.y();
  query.z = point.z();
  query.radius = radius;
  Measured measured{measure, search};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(implementation_->scene, &query, &context, measure_face, &measured);
}

bool EmbreeTree::cast(const TreeRay& ray, TreeHit& hit) const {
  RTCRayHit query{};
  query.ray = to_embree(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(implementation_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v};
  return true;
}

bool EmbreeTree::occluded(const TreeRay& ray) const {
  RTCRay query = to_embree(ray);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(implementation_->scene, &context, &query);
  return query.tfar < 0;
}

}  // namespace orbifit

#endif
