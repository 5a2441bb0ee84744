#include "finite_subgroup.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "orbifit/model/point_group.h"
#include "orbifit/model/point_index.h"

namespace orbifit {

namespace {

using Family = PointGroup::Family;

constexpr int kDefaultOrder = 12;
constexpr int kLargestOrder = 128;

// Some of the region's vertices, and an index over all of them.
struct RegionVertices {
  Points all;
  Points some;
  PointIndex index;
  double near;

  explicit RegionVertices(const Mesh& mesh, const Region& region)
      : all(submesh(mesh, region.faces).vertices), index(all), near(1e-6 * diagonal(mesh.vertices)) {
    const Eigen::Index step = std::max<Eigen::Index>(1, all.rows() / 200);
    std::vector<int> rows;
    for (Eigen::Index i = 0; i < all.rows(); i += step) rows.push_back(static_cast<int>(i));
    some = all(rows, Eigen::all);
  }

  bool mapped_onto_vertices(const Motion& motion) const {
    for (Eigen::Index i = 0; i < some.rows(); ++i) {
      const auto nearest = index.nearest(motion(some.row(i).transpose()), 1);
      if (nearest.empty() || nearest.front().distance > near) return false;
    }
    return true;
  }
};

Family finite_family(Family family) {
  switch (family) {
    case Family::Cinfv:
      return Family::Cnv;
    case Family::Cinfh:
      return Family::Cnh;
    case Family::Dinf:
      return Family::Dn;
    case Family::Dinfh:
      return Family::Dnh;
    case Family::K:
      return Family::T;
    case Family::Kh:
      return Family::Th;
    default:
      return Family::Cn;
  }
}

}  // namespace

PointGroup finite_subgroup(const Mesh& mesh, const Region& region) {
  const Family family = finite_family(region.group.family);
  if (family == Family::T || family == Family::Th) return {family, 1};
  const RegionVertices vertices(mesh, region);
  for (int n = kLargestOrder; n >= 3; --n) {
    if (vertices.mapped_onto_vertices(Motion::rotation(region.axis, 2 * std::numbers::pi / n, region.centre))) {
      return {family, n};
    }
  }
  return {family, kDefaultOrder};
}

std::vector<Motion> subgroup_elements(const Mesh& mesh, const Region& region, const PointGroup& finite) {
  GroupFrame frame = GroupFrame::Identity();
  if (finite.has_axis()) {
    frame = frame_about(region.axis);
    const RegionVertices vertices(mesh, region);
    for (Eigen::Index i = 0; i < vertices.some.rows(); ++i) {
      // A mirror through a vertex, or midway between two: its normal is a candidate for column 0.
      const Eigen::Vector3d offset = vertices.some.row(i).transpose() - region.centre;
      const Eigen::Vector3d across = region.axis.cross(offset);
      if (across.norm() < 1e-3 * diagonal(mesh.vertices)) continue;
      const GroupFrame candidate = frame_about(region.axis, across);
      const auto elements_here = generators(finite, candidate);
      if (std::ranges::all_of(elements_here, [&](const Eigen::Matrix3d& linear) {
            return vertices.mapped_onto_vertices(Motion::about(linear, region.centre));
          })) {
        frame = candidate;
        break;
      }
    }
  }
  std::vector<Motion> result;
  for (const Eigen::Matrix3d& linear : elements(finite, frame)) result.push_back(Motion::about(linear, region.centre));
  result.front() = Motion{};
  return result;
}

}  // namespace orbifit
