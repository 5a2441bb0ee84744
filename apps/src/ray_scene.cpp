#include "ray_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>

#include <Eigen/Geometry>
#include <tbb/task_arena.h>

#include "orbifit/model/errors.h"

#include "smooth_normals.h"

namespace orbifit {

namespace {

constexpr double kCreaseDegrees = 40;
const Colour kClay{0.80F, 0.785F, 0.76F};

// Bit k: the edge from corner k to the next is a side of the file's polygon, not a cut through it.
std::vector<std::uint8_t> polygon_sides(const Mesh& mesh) {
  std::vector<std::uint8_t> sides(static_cast<std::size_t>(mesh.faces.rows()), 7);
  for (std::size_t f = 0; f < mesh.polygon_of_face.size(); ++f) {
    // A fan: the first edge of a triangle lies inside unless it begins the polygon, the last unless it ends it.
    if (f > 0 && mesh.polygon_of_face[f - 1] == mesh.polygon_of_face[f]) sides[f] &= 6;
    if (f + 1 < sides.size() && mesh.polygon_of_face[f + 1] == mesh.polygon_of_face[f]) sides[f] &= 3;
  }
  return sides;
}

RTCRayHit ray_hit(const Ray& ray, float beyond, float up_to) {
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x();
  query.ray.org_y = ray.origin.y();
  query.ray.org_z = ray.origin.z();
  query.ray.dir_x = ray.direction.x();
  query.ray.dir_y = ray.direction.y();
  query.ray.dir_z = ray.direction.z();
  query.ray.tnear = beyond;
  query.ray.tfar = up_to;
  query.ray.mask = 0xFFFFFFFFU;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return query;
}

// What one ray crosses, gathered by a filter that lets it pass.
struct Crossings {
  static constexpr std::size_t kMax = 32;  // the nearest ones

  RTCIntersectContext context;  // first, so that Embree's pointer to it is one to all of this
  std::array<RTCRayHit, kMax> all;
  std::size_t count = 0;
};

bool nearer(const RTCRayHit& a, const RTCRayHit& b) {
  return a.ray.tfar < b.ray.tfar;
}

void let_pass(const RTCFilterFunctionNArguments* arguments) {
  auto& crossings = *reinterpret_cast<Crossings*>(arguments->context);
  arguments->valid[0] = 0;
  RTCRayHit crossing;
  crossing.ray = rtcGetRayFromRayN(arguments->ray, arguments->N, 0);
  crossing.hit = rtcGetHitFromHitN(arguments->hit, arguments->N, 0);
  if (crossings.count < Crossings::kMax) {
    crossings.all[crossings.count++] = crossing;
    return;
  }
  RTCRayHit& farthest = *std::ranges::max_element(crossings.all, nearer);
  if (nearer(crossing, farthest)) {
    farthest = crossing;
  } else {
    arguments->valid[0] = -1;  // nothing beyond it matters
  }
}

bool intersect(RTCScene scene, RTCRayHit& query) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
  return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

}  // namespace

Eigen::Vector3f linear_colour(const Colour& colour) {
  return colour.unaryExpr([](float c) {
    const float clamped = std::clamp(c, 0.0F, 1.0F);
    return clamped <= 0.04045F ? clamped / 12.92F : std::pow((clamped + 0.055F) / 1.055F, 2.4F);
  });
}

RayScene::RayScene(const Scene& scene, const Eigen::Matrix<double, 2, 3>& frame, float beside)
    : device_(rtcNewDevice("set_affinity=0")), centre_(0.5 * frame.row(0) + 0.5 * frame.row(1)) {
  if (device_ == nullptr) throw std::bad_alloc();  // for threads or their stacks
  const double size = (frame.row(1) - frame.row(0)).norm();
  scale_ = size > 0 ? 1 / size : 1;
  for (const SurfaceLayer& layer : scene.surfaces) {
    if (layer.mesh.faces.rows() == 0) continue;
    add_surface(layer.opacity < 1 ? glass_ : opaque_, layer);
    draws_edges_ = draws_edges_ || layer.edges;
  }
  for (const PointLayer& layer : scene.points) {
    if (layer.points.rows() == 0) continue;
    add_points(marks_, layer, layer.radius);
    add_points(thick_marks_, layer, layer.radius + beside);
  }
  for (const SegmentLayer& layer : scene.segments) {
    if (layer.from.rows() == 0) continue;
    add_segments(marks_, layer, layer.radius);
    add_segments(thick_marks_, layer, layer.radius + beside);
  }
  tbb::task_arena alone(1);  // Embree builds on the threads of the arena that it is called in
  for (const Part* part : {&opaque_, &glass_, &marks_, &thick_marks_}) {
    if (part->scene != nullptr) alone.execute([&] { rtcCommitScene(part->scene); });
  }
}

RayScene::~RayScene() {
  for (const Part* part : {&opaque_, &glass_, &marks_, &thick_marks_}) {
    if (part->scene != nullptr) rtcReleaseScene(part->scene);
  }
  rtcReleaseDevice(device_);
}

Eigen::Vector3f RayScene::to_scene(const Eigen::RowVector3d& point) const {
  return (scale_ * (point - centre_)).transpose().cast<float>();
}

void RayScene::attach(Part& part, RTCGeometry geometry, Layer layer) {
  if (part.scene == nullptr) {
    part.scene = rtcNewScene(device_);
    rtcSetSceneFlags(part.scene, &part == &glass_ ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION
                                                  : RTC_SCENE_FLAG_ROBUST);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(part.scene, geometry);  // numbered from 0
  rtcReleaseGeometry(geometry);
  part.layers.push_back(std::move(layer));
}

void RayScene::add_surface(Part& part, const SurfaceLayer& layer) {
  const auto vertex_count = static_cast<std::size_t>(layer.mesh.vertices.rows());
  const auto face_count = static_cast<std::size_t>(layer.mesh.faces.rows());
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertex_count));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), face_count));
  for (Eigen::Index v = 0; v < layer.mesh.vertices.rows(); ++v) {
    const Eigen::Vector3f point = to_scene(layer.mesh.vertices.row(v));
    positions = std::copy_n(point.data(), 3, positions);
  }
  std::transform(layer.mesh.faces.data(), layer.mesh.faces.data() + layer.mesh.faces.size(), indices,
                 [](int vertex) { return static_cast<unsigned>(vertex); });
  Layer entry;
  entry.surface = &layer;
  entry.corner_normals = corner_normals(layer.mesh, kCreaseDegrees);
  for (const Colour& colour : layer.face_colours) entry.face_colours.push_back(linear_colour(colour));
  if (layer.face_colours.empty()) entry.face_colours.push_back(linear_colour(kClay));
  if (layer.edges) entry.drawn_edges = polygon_sides(layer.mesh);
  attach(part, geometry, std::move(entry));
}

void RayScene::add_points(Part& part, const PointLayer& layer, double radius) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* spheres =
      static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                  4 * sizeof(float), static_cast<std::size_t>(layer.points.rows())));
  for (Eigen::Index p = 0; p < layer.points.rows(); ++p) {
    spheres = std::copy_n(to_scene(layer.points.row(p)).data(), 3, spheres);
    *spheres++ = static_cast<float>(radius);
  }
  Layer entry;
  entry.colour = linear_colour(layer.colour);
  attach(part, geometry, std::move(entry));
}

void RayScene::add_segments(Part& part, const SegmentLayer& layer, double radius) {
  const auto count = static_cast<std::size_t>(layer.from.rows());
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
  auto* ends = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 2 * count));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof(unsigned), count));
  for (std::size_t s = 0; s < count; ++s) {
    for (const Points* side : {&layer.from, &layer.to}) {
      ends = std::copy_n(to_scene(side->row(static_cast<Eigen::Index>(s))).data(), 3, ends);
      *ends++ = static_cast<float>(radius);
    }
    indices[s] = static_cast<unsigned>(2 * s);
  }
  Layer entry;
  entry.colour = linear_colour(layer.colour);
  attach(part, geometry, std::move(entry));
}

SurfaceHit RayScene::hit_of(const Part& part, const Ray& ray, const RTCRayHit& query) const {
  const Layer& layer = part.layers[query.hit.geomID];
  const SurfaceLayer& surface = *layer.surface;
  const auto face = static_cast<Eigen::Index>(query.hit.primID);
  const Eigen::Vector3f weights(1 - query.hit.u - query.hit.v, query.hit.u, query.hit.v);

  SurfaceHit result;
  result.distance = query.ray.tfar;
  result.position = ray.origin + query.ray.tfar * ray.direction;
  result.opacity = static_cast<float>(std::clamp(surface.opacity, 0.0, 1.0));
  const Eigen::Vector3f plane(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  result.geometric_normal = plane.stableNormalized();
  if (result.geometric_normal.dot(ray.direction) > 0) result.geometric_normal *= -1;

  Eigen::Vector3f corner[3];
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  result.lifted = result.position;
  for (int k = 0; k < 3; ++k) {
    corner[k] = to_scene(surface.mesh.vertices.row(surface.mesh.faces(face, k)));
    Eigen::Vector3f at_corner = layer.corner_normals[3 * query.hit.primID + static_cast<unsigned>(k)];
    if (at_corner.dot(result.geometric_normal) < 0) at_corner *= -1;
    normal += weights[k] * at_corner;
    const float below = std::min(0.0F, (result.position - corner[k]).dot(at_corner));
    result.lifted -= weights[k] * below * at_corner;
  }
  result.normal = normal.squaredNorm() > 1e-8F ? normal.normalized() : result.geometric_normal;
  // A smooth normal may turn away from the viewer at a silhouette; bend it back to the rim.
  const float facing = result.normal.dot(ray.direction);
  if (facing > 0) result.normal = (result.normal - 1.01F * facing * ray.direction).normalized();

  if (!surface.vertex_colours.empty()) {
    Colour colour = Colour::Zero();
    for (int k = 0; k < 3; ++k) {
      colour += weights[k] * surface.vertex_colours[static_cast<std::size_t>(surface.mesh.faces(face, k))];
    }
    result.colour = linear_colour(colour);
  } else {
    result.colour = layer.face_colours[layer.face_colours.size() == 1 ? 0 : static_cast<std::size_t>(face)];
  }
  if (!layer.drawn_edges.empty()) {
    const float half_width = 0.45F * pixel_width * result.distance;
    float nearest = std::numeric_limits<float>::infinity();
    const float double_area = (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm();
    for (int k = 0; k < 3; ++k) {
      if ((layer.drawn_edges[query.hit.primID] >> k & 1) == 0) continue;
      const float length = (corner[(k + 1) % 3] - corner[k]).norm();
      if (length > 0) nearest = std::min(nearest, weights[(k + 2) % 3] * double_area / length);
    }
    if (nearest < half_width) result.colour *= 0.3F;
  }
  return result;
}

std::optional<SurfaceHit> RayScene::surface(const Ray& ray, float up_to) const {
  if (opaque_.scene == nullptr) return std::nullopt;
  RTCRayHit query = ray_hit(ray, 0, up_to);
  if (!intersect(opaque_.scene, query)) return std::nullopt;
  return hit_of(opaque_, ray, query);
}

void RayScene::glass(const Ray& ray, float up_to, int most, const std::function<void(const SurfaceHit&)>& visit) const {
  if (glass_.scene == nullptr) return;
  Crossings crossings;
  rtcInitIntersectContext(&crossings.context);
  crossings.context.filter = let_pass;
  RTCRayHit query = ray_hit(ray, 0, up_to);
  rtcIntersect1(glass_.scene, &crossings.context, &query);
  const auto end = crossings.all.begin() + static_cast<std::ptrdiff_t>(crossings.count);
  std::sort(crossings.all.begin(), end, nearer);
  float beyond = 0;
  for (auto crossing = crossings.all.begin(); crossing != end && most > 0; ++crossing) {
    if (crossing->ray.tfar < beyond) continue;  // the same sheet once more
    const SurfaceHit hit = hit_of(glass_, ray, *crossing);
    visit(hit);
    beyond = hit.distance * (1 + 1e-5F) + 1e-6F;
    --most;
  }
}

std::optional<MarkHit> RayScene::mark(const Ray& ray, float up_to) const {
  if (marks_.scene == nullptr) return std::nullopt;
  RTCRayHit query = ray_hit(ray, 0, up_to);
  if (!intersect(marks_.scene, query)) return std::nullopt;
  MarkHit result;
  result.distance = query.ray.tfar;
  result.normal = Eigen::Vector3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).stableNormalized();
  if (result.normal.dot(ray.direction) > 0) result.normal *= -1;
  result.colour = marks_.layers[query.hit.geomID].colour;
  return result;
}

bool RayScene::near_mark(const Ray& ray) const {
  if (thick_marks_.scene == nullptr) return false;
  RTCRay query = ray_hit(ray, 0, std::numeric_limits<float>::infinity()).ray;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(thick_marks_.scene, &context, &query);
  return query.tfar < 0;
}

unsigned RayScene::occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f* directions, int count,
                            float reach) const {
  if (opaque_.scene == nullptr) return 0;
  RTCRay8 rays{};
  alignas(32) int valid[8] = {};
  for (int i = 0; i < count; ++i) {
    valid[i] = -1;
    rays.org_x[i] = origin.x();
    rays.org_y[i] = origin.y();
    rays.org_z[i] = origin.z();
    rays.dir_x[i] = directions[i].x();
    rays.dir_y[i] = directions[i].y();
    rays.dir_z[i] = directions[i].z();
    rays.tfar[i] = reach;
    rays.mask[i] = 0xFFFFFFFFU;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded8(valid, opaque_.scene, &context, &rays);
  unsigned blocked = 0;
  for (int i = 0; i < count; ++i) {
    if (rays.tfar[i] < 0) blocked |= 1U << static_cast<unsigned>(i);
  }
  return blocked;
}

}  // namespace orbifit
