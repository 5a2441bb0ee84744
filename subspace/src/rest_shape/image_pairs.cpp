#include "rest_shape/image_pairs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::size_t kMaxPairs = 200000;  // of a region: a second of nearest points
// Cosines between the normals of an image and of a face: on the back of a thin part, and on its own side.
constexpr double kOtherSide = -0.2;
constexpr double kSameSide = 0.2;
constexpr double kThinness = 0.01;  // of the diagonal: how much farther the own side may be

constexpr double kOneSide = 0.999;  // cosine between normals that one probe stands for

// The region's vertices, those at one place with one normal counted once.
std::vector<Probe> probes_of(const Mesh& mesh, const Places& places, const std::vector<int>& faces) {
  std::vector<int> vertices;
  const Points normals = vertex_normals(submesh(mesh, faces, &vertices));
  std::vector<Probe> probes;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    probes.push_back({places.of_vertex[static_cast<std::size_t>(vertices[v])], normals.row(static_cast<Index>(v))});
  }
  std::ranges::stable_sort(probes, {}, &Probe::place);
  std::vector<Probe> result;
  std::size_t first = 0;  // of the place's
  for (const Probe& probe : probes) {
    if (first < result.size() && result[first].place != probe.place) first = result.size();
    const bool known = std::any_of(
        result.begin() + static_cast<std::ptrdiff_t>(first), result.end(),
        [&](const Probe& other) { return other.normal.dot(probe.normal) > kOneSide || other.normal == probe.normal; });
    if (!known) result.push_back(probe);
  }
  return result;
}

}  // namespace

RegionDemand region_demand(const Mesh& mesh, const Places& places, const Region& region,
                           const std::optional<Region>& finite, bool any_turn) {
  RegionDemand demand;
  if (region.faces.empty()) return demand;
  demand.probes = probes_of(mesh, places, region.faces);
  demand.faces = region.faces;
  demand.of_finite_group = finite.has_value();
  if (!finite || any_turn) {
    for (const double angle : {0.3, 1.7, 4.4}) {  // as few finite groups have them
      const Vector3d axis = region.group.has_axis() ? region.axis : Vector3d(1, angle, -2);
      demand.motions.push_back(Motion::rotation(axis.normalized(), angle, region.centre));
    }
  }
  if (!finite) return demand;
  const std::size_t elements = finite->elements.size();
  const std::size_t most = std::max<std::size_t>(1, kMaxPairs / demand.probes.size());
  const std::size_t stride = (elements + most - 1) / most;
  for (std::size_t e = 1; e < elements; e += stride) demand.motions.push_back(finite->elements[e]);
  return demand;
}

ImagePairs::ImagePairs(const Mesh& mesh, const Places& places, std::vector<RegionDemand> demands)
    : demands_(std::move(demands)), first_{0}, mesh_{places.positions, mesh.faces, {}} {
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) mesh_.faces(f, k) = places.of_vertex[static_cast<std::size_t>(mesh.faces(f, k))];
  }
  surfaces_.reserve(demands_.size());
  for (const RegionDemand& demand : demands_) {
    first_.push_back(first_.back() + demand.probes.size() * demand.motions.size());
    surfaces_.emplace_back(mesh_, demand.faces);
  }
}

int ImagePairs::region_of(std::size_t pair) const {
  return static_cast<int>(std::ranges::upper_bound(first_, pair) - first_.begin()) - 1;
}

ImagePairs::Pair ImagePairs::operator[](std::size_t pair) const {
  const int region = region_of(pair);
  const RegionDemand& demand = demands_[static_cast<std::size_t>(region)];
  const std::size_t number = pair - first_[static_cast<std::size_t>(region)];
  return {region, demand.probes[number / demand.motions.size()].place, &demand.motions[number % demand.motions.size()]};
}

std::vector<SurfaceMatch> ImagePairs::match(const Points& positions, const std::vector<std::vector<char>>* wanted,
                                            const RunContext& context, double reach, std::size_t most) {
  std::vector<SurfaceMatch> result(count());
  mesh_.vertices = positions;
  const Points normals_of_faces = face_normals(mesh_);
  const double thinness = kThinness * diagonal(positions);
  for (std::size_t r = 0; r < demands_.size(); ++r) {
    context.check();
    const RegionDemand& demand = demands_[r];
    if (first_[r + 1] == first_[r]) continue;
    surfaces_[r].move(mesh_, context);
    const MovingSurface& surface = surfaces_[r];
    const std::size_t asked =
        wanted == nullptr ? demand.probes.size() : static_cast<std::size_t>(std::ranges::count((*wanted)[r], 1));
    const std::size_t stride = std::clamp<std::size_t>(asked * demand.motions.size() / most, 1, demand.motions.size());
    parallel_for(context, demand.probes.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (wanted != nullptr && (*wanted)[r][i] == 0) continue;
        const Probe& probe = demand.probes[i];
        for (std::size_t e = i % stride; e < demand.motions.size(); e += stride) {
          const Motion& motion = demand.motions[e];
          const Vector3d image = motion(positions.row(probe.place).transpose());
          const Vector3d normal = motion.linear * probe.normal;
          MovingSurface::Nearest nearest = surface.nearest(image, reach);
          if (nearest.face < 0) continue;
          if (normals_of_faces.row(nearest.face).dot(normal) < kOtherSide) {
            const auto facing = surface.nearest_facing(image, normal, kSameSide, nearest.distance + thinness);
            if (facing.face >= 0) nearest = facing;
          }
          result[first_[r] + i * demand.motions.size() + e] = {nearest.face, nearest.barycentric, nearest.distance};
        }
      }
    });
  }
  return result;
}

}  // namespace orbifit
