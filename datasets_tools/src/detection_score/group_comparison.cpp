#include "detection_score/group_comparison.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "base/dense.h"

namespace orbifit::scoring {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kNoTurn = 1e-3;        // radians
constexpr double kSameAngle = 2;        // degrees, of turns of one kind
constexpr double kAxisTolerance = 3;    // degrees, between groups of different symbols
constexpr double kMemberTolerance = 6;  // degrees, of a finite group's elements in a continuous group

// Continuous groups that hold others properly, and those that are half of another.
struct Containment {
  Family large;
  std::initializer_list<Family> smaller, half;
};

const Containment kContainments[] = {
    {Family::Cinf, {}, {}},
    {Family::Cinfv, {Family::Cinf}, {Family::Cinf}},
    {Family::Cinfh, {Family::Cinf}, {Family::Cinf}},
    {Family::Dinf, {Family::Cinf}, {Family::Cinf}},
    {Family::Dinfh,
     {Family::Cinf, Family::Cinfv, Family::Cinfh, Family::Dinf},
     {Family::Cinfv, Family::Cinfh, Family::Dinf}},
    {Family::K, {Family::Cinf, Family::Dinf}, {}},
    {Family::Kh, {Family::Cinf, Family::Cinfv, Family::Cinfh, Family::Dinf, Family::Dinfh, Family::K}, {Family::K}},
};

bool holds(Family large, Family small) {
  const auto& row = *std::ranges::find(kContainments, large, &Containment::large);
  return large == small || std::ranges::find(row.smaller, small) != row.smaller.end();
}

bool is_half(Family small, Family large) {
  const auto& row = *std::ranges::find(kContainments, large, &Containment::large);
  return std::ranges::find(row.half, small) != row.half.end();
}

Matrix3d fixed_directions(const Region& region) {
  if (region.group.continuous()) {
    const bool line = region.group.family == Family::Cinf || region.group.family == Family::Cinfv;
    return line ? Matrix3d(region.axis * region.axis.transpose()) : Matrix3d(Matrix3d::Zero());
  }
  // The null space of all (R - 1) together.
  Matrix3d normal = Matrix3d::Zero();
  for (const Motion& element : region.elements) {
    const Matrix3d moved = element.linear - Matrix3d::Identity();
    normal += moved.transpose() * moved;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(normal);
  Matrix3d result = Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vector3d direction = solver.eigenvectors().col(k);
    if (solver.eigenvalues()[k] < 1e-6 * std::max(1.0, solver.eigenvalues()[2])) {
      result += direction * direction.transpose();
    }
  }
  return result;
}

// Largest angle from an axis of `of` to the nearest one of the same kind of `among`, in degrees.
double orientation_error(const PlacedGroup& of, const PlacedGroup& among) {
  double worst = 0;
  for (const AxisAngle& part : of.parts) {
    if (part.angle < kNoTurn) {
      const auto inversion = [](const AxisAngle& other) { return other.determinant < 0 && other.angle < 0.05; };
      if (part.determinant < 0 && std::ranges::none_of(among.parts, inversion)) return 180;
      continue;
    }
    double best = 180;
    for (const AxisAngle& other : among.parts) {
      if (other.determinant != part.determinant || std::abs(other.angle - part.angle) * kDegrees >= kSameAngle)
        continue;
      best = std::min(best, angle_between_axes(part.axis, other.axis));
    }
    worst = std::max(worst, best);
  }
  return worst;
}

void compare_continuous(const Region& truth, const Region& predicted, GroupComparison& result) {
  result.contains = holds(predicted.group.family, truth.group.family);
  result.half = is_half(predicted.group.family, truth.group.family);
  const bool both = truth.group.has_axis() && predicted.group.has_axis();
  result.axis_error = both ? angle_between_axes(truth.axis, predicted.axis) : 0;
}

void compare_with_continuous(const Region& truth, const Region& predicted, GroupComparison& result) {
  result.contains = std::ranges::all_of(truth.elements, [&](const Motion& element) {
    return in_continuous_group(element.linear, predicted.group.family, predicted.axis, kMemberTolerance);
  });
  if (!result.contains) return;
  // The plane of a mirror may hold the axis, or be across it.
  const bool comparable = predicted.group.has_axis() && truth.group.has_axis() && truth.group.family != Family::Cs;
  result.axis_error = comparable ? angle_between_axes(predicted.axis, truth.axis) : 0;
}

void compare_finite(const PlacedGroup& truth, const PlacedGroup& predicted, GroupComparison& result) {
  const double found = orientation_error(truth, predicted);
  if (result.same || found <= kAxisTolerance) {
    result.contains = true;
    result.axis_error = found;
  } else if (2 * predicted.parts.size() == truth.parts.size()) {
    const double given = orientation_error(predicted, truth);
    if (given > kAxisTolerance) return;
    result.half = true;
    result.axis_error = given;
  }
}

}  // namespace

PlacedGroup::PlacedGroup(const Region& given) : region(given), onto_fixed(fixed_directions(given)) {
  for (const Motion& element : given.elements) parts.push_back(axis_angle(element.linear));
}

Vector3d PlacedGroup::fixed_point(const Vector3d& p) const {
  return region.centre + onto_fixed * (p - region.centre);
}

double angle_between_axes(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))) * kDegrees;
}

bool in_continuous_group(const Matrix3d& linear, Family family, const Vector3d& axis, double degrees) {
  const bool proper = linear.determinant() > 0;
  if (family == Family::Kh) return true;
  if (family == Family::K) return proper;
  const Vector3d image = linear * axis;
  if (angle_between_axes(axis, image) > degrees) return false;
  const bool kept = axis.dot(image) > 0;
  switch (family) {
    case Family::Cinf:
      return proper && kept;
    case Family::Cinfv:
      return kept;
    case Family::Cinfh:
      return proper == kept;
    case Family::Dinf:
      return proper;
    default:
      return family == Family::Dinfh;
  }
}

GroupComparison compare_groups(const PlacedGroup& truth, const PlacedGroup& predicted, const Vector3d& centroid) {
  GroupComparison result;
  const bool continuous_truth = truth.region.group.continuous();
  const bool continuous_prediction = predicted.region.group.continuous();
  result.same = truth.region.group == predicted.region.group;
  if (continuous_truth && continuous_prediction) {
    compare_continuous(truth.region, predicted.region, result);
  } else if (continuous_prediction) {
    compare_with_continuous(truth.region, predicted.region, result);
  } else if (!continuous_truth) {
    compare_finite(truth, predicted, result);
  }
  const Vector3d place = truth.fixed_point(centroid);
  if (result.contains && !result.same) {
    // A larger group fixes less: what it fixes has to be fixed by the true one.
    const Vector3d fixed = predicted.fixed_point(place);
    result.offset = (fixed - truth.fixed_point(fixed)).norm();
  } else {
    result.offset = (place - predicted.fixed_point(place)).norm();
  }
  return result;
}

}  // namespace orbifit::scoring
