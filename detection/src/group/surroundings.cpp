#include "group/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "group/verification.h"
#include "surface/creases.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Family = PointGroup::Family;
using Corners = std::array<Vector3d, 3>;

constexpr int kSurroundingSamples = 1500;
constexpr double kMinSurroundings = 0.02;  // of the diagonal
constexpr double kFineness = 5;            // pieces of triangle on the reach

bool about_point(const PointGroup& group) {
  return group.family == Family::K || group.family == Family::Kh;
}

// How far a point is from what the group leaves in place: a plane, an axis, or the centre.
double offset(const GroupPlacement& placement, const Vector3d& point) {
  const Vector3d from = point - placement.centre;
  if (!placement.group.has_axis()) return from.norm();
  const Vector3d axis = placement.frame.col(2);
  return placement.group.family == Family::Cs ? std::abs(axis.dot(from)) : axis.cross(from).norm();
}

/// Distance to the images of a point under the group.
class OrbitDistance {
 public:
  OrbitDistance(const GroupPlacement& placement, const Vector3d& point) : placement_(placement), point_(point) {
    if (placement.group.continuous()) return;
    images_.push_back(point);
    for (const Motion& motion : judged_motions(placement.group, placement.frame, placement.centre)) {
      images_.push_back(motion(point));
    }
  }

  double operator()(const Vector3d& place) const {
    if (!images_.empty()) {
      double least = std::numeric_limits<double>::infinity();
      for (const Vector3d& image : images_) least = std::min(least, (place - image).norm());
      return least;
    }
    const double across = offset(placement_, place) - offset(placement_, point_);
    if (about_point(placement_.group)) return std::abs(across);
    const double along = placement_.frame.col(2).dot(place - point_);
    return std::hypot(across, along);
  }

 private:
  const GroupPlacement& placement_;
  Vector3d point_;
  std::vector<Vector3d> images_;
};

struct Fragment {
  Vector3d centroid;
  double area;
  int face;
};

/// Cuts triangles until they are small, and keeps what lies near.
class Cutter {
 public:
  Cutter(std::vector<OrbitDistance> orbits, double reach, std::vector<Fragment>& fragments)
      : orbits_(std::move(orbits)), reach_(reach), fragments_(fragments) {}

  void cut(const Corners& c, int face) {
    const Vector3d centroid = (c[0] + c[1] + c[2]) / 3;
    std::array<double, 3> edges{};
    double extent = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      edges[k] = (c[(k + 1) % 3] - c[k]).norm();
      extent = std::max(extent, (c[k] - centroid).norm());
    }
    double distance = std::numeric_limits<double>::infinity();
    for (const OrbitDistance& orbit : orbits_) distance = std::min(distance, orbit(centroid));
    if (distance > reach_ + extent) return;
    const auto longest = static_cast<std::size_t>(std::ranges::max_element(edges) - edges.begin());
    if (edges[longest] <= reach_ / kFineness) {
      const double area = (c[1] - c[0]).cross(c[2] - c[0]).norm() / 2;
      if (distance <= reach_ && area > 0) fragments_.push_back({centroid, area, face});
      return;
    }
    const Vector3d middle = (c[longest] + c[(longest + 1) % 3]) / 2;
    const Vector3d& apex = c[(longest + 2) % 3];
    cut({c[longest], middle, apex}, face);
    cut({middle, c[(longest + 1) % 3], apex}, face);
  }

 private:
  std::vector<OrbitDistance> orbits_;
  double reach_;
  std::vector<Fragment>& fragments_;
};

// Every so much area one fragment, in the order of the faces.
std::vector<Fragment> thinned(const std::vector<Fragment>& fragments, double area) {
  const double step = area / kSurroundingSamples;
  std::vector<Fragment> result;
  double sum = 0;
  double next = step / 2;
  for (const Fragment& fragment : fragments) {
    sum += fragment.area;
    if (sum < next) continue;
    result.push_back(fragment);
    next += step * std::ceil((sum - next) / step + 1e-12);
  }
  return result;
}

}  // namespace

SurfacePatch surroundings(const PreparedMesh& prepared, const std::shared_ptr<const SurfaceIndex>& whole,
                          const GroupPlacement& placement, const std::vector<int>& seeds, double tolerance,
                          const RunContext& context) {
  const auto corners = [&](int face) {
    Corners result;
    for (int k = 0; k < 3; ++k) {
      result[static_cast<std::size_t>(k)] = prepared.mesh.vertices.row(prepared.mesh.faces(face, k));
    }
    return result;
  };
  std::vector<OrbitDistance> orbits;
  double reach = kMinSurroundings;
  for (const int seed : seeds) {
    const Corners c = corners(seed);
    const Vector3d centroid = (c[0] + c[1] + c[2]) / 3;
    orbits.emplace_back(placement, centroid);
    reach = std::max(reach, offset(placement, centroid));
  }
  std::vector<Fragment> fragments;
  Cutter cutter(std::move(orbits), reach, fragments);
  double area = 0;
  for (int f = 0; f < prepared.mesh.faces.rows(); ++f) {
    if (f % 1024 == 0) context.check();
    if (prepared.areas[f] > 0) cutter.cut(corners(f), f);
  }
  for (const Fragment& fragment : fragments) area += fragment.area;

  SurfacePatch patch;
  patch.prepared = &prepared;
  patch.index = whole;
  patch.relative_tolerance = tolerance;
  Eigen::AlignedBox3d box;
  patch.moments.area = area;
  for (const Fragment& fragment : fragments) {
    if (patch.faces.empty() || patch.faces.back() != fragment.face) patch.faces.push_back(fragment.face);
    patch.moments.centroid += fragment.area / area * fragment.centroid;
    box.extend(fragment.centroid);
  }
  patch.moments.diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
  patch.tolerance = tolerance_of_part(tolerance, patch.moments.diagonal);
  const std::vector<Fragment> chosen = thinned(fragments, area);
  const auto count = static_cast<Eigen::Index>(chosen.size());
  patch.samples.points.resize(count, 3);
  patch.samples.normals.resize(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Fragment& fragment = chosen[static_cast<std::size_t>(i)];
    patch.samples.points.row(i) = fragment.centroid;
    patch.samples.normals.row(i) = prepared.normals.row(fragment.face);
    patch.samples.faces.push_back(fragment.face);
    patch.at_crease.push_back(
        near_crease(prepared, fragment.centroid, fragment.face, kCreaseReach * patch.tolerance) ? 1 : 0);
    patch.moments.radius = std::max(patch.moments.radius, (fragment.centroid - patch.moments.centroid).norm());
  }
  return patch;
}

}  // namespace orbifit
