#include "detection_score/region_validity.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

namespace orbifit::scoring {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kMaxTried = 60;
constexpr int kTurns = 24;
constexpr int kTurnsOfFourCosets = 15;
constexpr double kNoMotion = 1e-3;

std::vector<Motion> tried_of_finite(const Region& region, Random& random) {
  std::vector<Motion> rest(region.elements.begin() + 1, region.elements.end());
  if (static_cast<int>(rest.size()) <= kMaxTried) return rest;
  std::vector<Motion> result;
  for (const Motion& generator : region.generators) {
    if ((generator.linear - Matrix3d::Identity()).cwiseAbs().maxCoeff() > kNoMotion) result.push_back(generator);
  }
  for (std::size_t i = 0; static_cast<int>(result.size()) < kMaxTried; ++i) {
    std::swap(rest[i], rest[i + random.below(rest.size() - i)]);
    result.push_back(rest[i]);
  }
  return result;
}

// What has to be tried beside the turns about the axis.
std::vector<Matrix3d> cosets(Family family, const Vector3d& axis) {
  const Vector3d across = axis.unitOrthogonal();
  const Matrix3d upright = Matrix3d::Identity() - 2 * across * across.transpose();
  const Matrix3d level = Matrix3d::Identity() - 2 * axis * axis.transpose();
  const Matrix3d half_turn = axis_rotation(across, std::numbers::pi);
  switch (family) {
    case Family::Cinfv:
      return {Matrix3d::Identity(), upright};
    case Family::Cinfh:
      return {Matrix3d::Identity(), level};
    case Family::Dinf:
      return {Matrix3d::Identity(), half_turn};
    case Family::Dinfh:
      return {Matrix3d::Identity(), upright, level, half_turn};
    default:
      return {Matrix3d::Identity()};
  }
}

}  // namespace

std::vector<Motion> tried_elements(const Region& region, Random& random) {
  const Family family = region.group.family;
  if (!region.group.continuous()) return tried_of_finite(region, random);
  std::vector<Motion> result;
  if (family == Family::K || family == Family::Kh) {
    for (int i = 0; i < kTurns; ++i) result.push_back(Motion::about(random.rotation(), region.centre));
    for (int i = 0; i < kTurns && family == Family::Kh; ++i) {
      result.push_back(Motion::about(-random.rotation(), region.centre));
    }
    return result;
  }
  const int count = family == Family::Dinfh ? kTurnsOfFourCosets : kTurns;
  for (const Matrix3d& coset : cosets(family, region.axis)) {
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * (i + random.uniform()) / count;
      result.push_back(Motion::about(axis_rotation(region.axis, angle) * coset, region.centre));
    }
  }
  return result;
}

double region_validity(const ScoredSurface& surface, const Region& region, int samples, Random& random,
                       const RunContext& context) {
  if (surface.empty()) return 0;
  const std::vector<Motion> elements = tried_elements(region, random);
  return surface.fit_under_all(surface.sample(samples, random, context), elements, context);
}

}  // namespace orbifit::scoring
