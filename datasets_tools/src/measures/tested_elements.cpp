#include "measures/tested_elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "base/random.h"
#include "geometry/point_index.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kMaxTurns = 12;
constexpr int kTrialVertices = 300;
constexpr int kTrialDirections = 64;
constexpr int kMaxFacets = 64;
constexpr std::array<int, 15> kFurtherFacets{72, 80, 90, 96, 100, 120, 128, 144, 160, 180, 192, 200, 240, 256, 360};

// `count` numbers spread evenly over [first, last], without repetition.
std::vector<int> spread(int first, int last, int count) {
  std::vector<int> result;
  const int steps = std::min(count, last - first + 1);
  for (int i = 0; i < steps; ++i) {
    const double share = steps > 1 ? static_cast<double>(i) / (steps - 1) : 0;
    const int value = static_cast<int>(std::lround(first + share * (last - first)));
    if (result.empty() || result.back() != value) result.push_back(value);
  }
  return result;
}

Matrix3d mirror(const Vector3d& normal) {
  return Matrix3d::Identity() - 2 * normal * normal.transpose();
}

// How well linear maps of the region's vertices about its centre put them onto vertices.
class Tessellation {
 public:
  Tessellation(const RegionSurface& surface, const Vector3d& centre)
      : points_(surface.positions().rowwise() - centre.transpose()), index_(points_) {
    trial_ = spread(0, static_cast<int>(points_.rows()) - 1, kTrialVertices);
  }

  const Points& points() const { return points_; }

  double error(const Matrix3d& linear) const {
    double sum = 0;
    for (const int v : trial_) {
      const double distance = index_.nearest(linear * points_.row(v).transpose(), 1).front().distance;
      sum += distance * distance;
    }
    return std::sqrt(sum / static_cast<double>(trial_.size()));
  }

 private:
  Points points_;
  PointIndex index_;
  std::vector<int> trial_;
};

// The finest n for which turns by 2 pi / n disturb the tessellation least.
int facets_about(const Vector3d& axis, const Tessellation& tessellation, double tie) {
  std::vector<int> trials;
  for (int n = 5; n <= kMaxFacets; ++n) trials.push_back(n);
  trials.insert(trials.end(), kFurtherFacets.begin(), kFurtherFacets.end());
  std::vector<double> errors;
  errors.reserve(trials.size());
  for (const int n : trials) errors.push_back(tessellation.error(axis_rotation(axis, 2 * std::numbers::pi / n)));
  const double least = *std::ranges::min_element(errors);
  int result = trials.front();
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (errors[i] <= least + tie) result = trials[i];
  }
  return result;
}

// A direction across the axis that spans with it a mirror plane of the tessellation.
Vector3d mirror_direction(const Vector3d& axis, const Tessellation& tessellation, double tie) {
  const Points& points = tessellation.points();
  const Points across = points - (points * axis) * axis.transpose();
  const Eigen::VectorXd radius = across.rowwise().norm();
  Vector3d result = axis.unitOrthogonal();
  std::vector<int> far;
  for (int v = 0; v < radius.size(); ++v) {
    if (radius[v] > 0.02 * radius.maxCoeff()) far.push_back(v);
  }
  double best = std::numeric_limits<double>::infinity();
  for (const int i : spread(0, static_cast<int>(far.size()) - 1, kTrialDirections)) {
    const int v = far[static_cast<std::size_t>(i)];
    const Vector3d direction = across.row(v).transpose() / radius[v];
    const double error = tessellation.error(mirror(axis.cross(direction)));
    if (error >= best - tie) continue;
    best = error;
    result = direction;
  }
  return result;
}

std::vector<Matrix3d> axial_elements(const Region& region, const RegionSurface& surface) {
  const Tessellation tessellation(surface, region.centre);
  const double tie = 1e-9 * diagonal(surface.positions());
  const Vector3d axis = region.axis.normalized();
  const int facets = facets_about(axis, tessellation, tie);
  std::vector<Matrix3d> result;
  for (const int k : spread(1, facets - 1, kMaxTurns)) {
    result.push_back(axis_rotation(axis, 2 * std::numbers::pi * k / facets));
  }
  const Family family = region.group.family;
  if (family == Family::Cinfh || family == Family::Dinfh) result.push_back(mirror(axis));
  if (family == Family::Cinf || family == Family::Cinfh) return result;
  const Vector3d along = mirror_direction(axis, tessellation, tie);
  for (const Vector3d& direction : {along, Vector3d(axis.cross(along))}) {
    if (family == Family::Cinfv || family == Family::Dinfh) result.push_back(mirror(direction));
    if (family == Family::Dinf || family == Family::Dinfh) result.push_back(-mirror(direction));  // half turn
  }
  return result;
}

}  // namespace

std::vector<Motion> tested_elements(const Region& region, const RegionSurface& surface) {
  std::vector<Motion> result;
  const auto add = [&](const Matrix3d& linear, const Vector3d& translation) {
    result.push_back({linear, translation});
  };
  if (!region.group.continuous()) {
    const double reach = diagonal(surface.positions());
    for (const Motion& element : region.elements) {
      const Vector3d shift = element(region.centre) - region.centre;
      const bool identity = (element.linear - Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-9;
      if (!identity || shift.norm() > 1e-9 * reach) add(element.linear, shift);
    }
    return result;
  }
  std::vector<Matrix3d> linear;
  if (region.group.has_axis()) {
    linear = axial_elements(region, surface);
  } else {
    Random random(5, "tested elements");
    for (int k = 0; k < kMaxTurns; ++k) linear.push_back(random.rotation());
    if (region.group.family == Family::Kh) linear.push_back(-Matrix3d::Identity());
  }
  for (const Matrix3d& matrix : linear) add(matrix, Vector3d::Zero());
  return result;
}

}  // namespace orbifit
