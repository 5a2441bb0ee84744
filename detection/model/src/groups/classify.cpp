#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "orbifit/model/point_group.h"

namespace orbifit {

namespace {

using Family = PointGroup::Family;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Axis {
  Vector3d direction;
  int order;  // number of rotations about it, the identity included
};

struct Inventory {
  std::vector<Axis> axes;         // of the proper rotations, by descending order
  std::vector<Vector3d> mirrors;  // normals
  int proper = 0;
  int improper = 0;
  bool inversion = false;
};

Inventory take_inventory(const std::vector<Matrix3d>& linear, double tolerance) {
  Inventory result;
  for (const Matrix3d& matrix : linear) {
    const AxisAngle part = axis_angle(matrix);
    if (part.determinant < 0) {
      ++result.improper;
      if (part.angle < tolerance) result.inversion = true;
      if (part.angle > std::numbers::pi - tolerance) result.mirrors.push_back(part.axis);
      continue;
    }
    ++result.proper;
    if (part.angle < tolerance) continue;
    const auto same = std::ranges::find_if(
        result.axes, [&](const Axis& axis) { return axis.direction.cross(part.axis).norm() < 4 * tolerance; });
    if (same != result.axes.end()) {
      ++same->order;
    } else {
      result.axes.push_back({part.axis, 2});
    }
  }
  std::ranges::stable_sort(result.axes, std::greater<>(), &Axis::order);
  return result;
}

bool perpendicular(const Vector3d& a, const Vector3d& b, double tolerance) {
  return std::abs(a.dot(b)) < tolerance;
}

GroupFrame orthogonal_axes_frame(const std::vector<Axis>& axes, int order, double tolerance) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t j = i + 1; j < axes.size(); ++j) {
      if (axes[i].order != order || axes[j].order != order) continue;
      if (!perpendicular(axes[i].direction, axes[j].direction, tolerance)) continue;
      return frame_about(axes[i].direction, axes[j].direction);
    }
  }
  return GroupFrame::Identity();
}

bool reproduces(const ClassifiedGroup& candidate, const std::vector<Matrix3d>& linear, double tolerance) {
  const std::vector<Matrix3d> exact = elements(candidate.group, candidate.frame);
  if (exact.size() != linear.size()) return false;
  return std::ranges::all_of(exact, [&](const Matrix3d& element) {
    return std::ranges::any_of(
        linear, [&](const Matrix3d& given) { return (given - element).cwiseAbs().maxCoeff() < tolerance; });
  });
}

GroupFrame quarter_turn() {
  GroupFrame turn;
  turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  return turn;
}

// The groups that could have this inventory, with their frames; reproduces() decides.
std::vector<ClassifiedGroup> candidates(const Inventory& have, double tolerance) {
  const auto axis_frame = [&](const Vector3d& axis, const std::vector<Vector3d>& across) {
    for (const Vector3d& direction : across) {
      if (perpendicular(axis, direction, tolerance)) return frame_about(axis, direction);
    }
    return frame_about(axis);
  };
  std::vector<ClassifiedGroup> result;
  const auto add = [&](Family family, int n, const GroupFrame& frame) { result.push_back({{family, n}, frame}); };
  if (have.axes.empty()) {
    if (have.improper == 0) add(Family::C1, 1, GroupFrame::Identity());
    if (have.inversion) add(Family::Ci, 1, GroupFrame::Identity());
    if (!have.mirrors.empty()) add(Family::Cs, 1, frame_about(have.mirrors.front()));
    return result;
  }
  if (have.axes.size() == 1) {
    const Axis& main = have.axes.front();
    add(Family::Cn, main.order, frame_about(main.direction));
    add(Family::Cnv, main.order, axis_frame(main.direction, have.mirrors));
    add(Family::Cnh, main.order, frame_about(main.direction));
    add(Family::Sn, 2 * main.order, frame_about(main.direction));
    return result;
  }
  if (have.proper == 12 || have.proper == 24) {
    const int order = have.proper == 12 ? 2 : 4;
    const GroupFrame frame = orthogonal_axes_frame(have.axes, order, tolerance);
    for (const Family family : {Family::T, Family::Td, Family::Th, Family::O, Family::Oh}) add(family, 1, frame);
  }
  if (have.proper == 60) {
    const GroupFrame frame = orthogonal_axes_frame(have.axes, 2, tolerance);
    for (const Family family : {Family::I, Family::Ih}) {
      add(family, 1, frame);
      add(family, 1, frame * quarter_turn());
    }
  }
  std::vector<Vector3d> twofold;
  for (const Axis& axis : have.axes) {
    if (axis.order == 2) twofold.push_back(axis.direction);
  }
  // D2, D2h and D2d have three axes of order 2, any of which may be the main one; else the first axis is.
  for (const Axis& main : have.axes) {
    if (main.order < have.axes.front().order) break;
    const GroupFrame frame = axis_frame(main.direction, twofold);
    for (const Family family : {Family::Dn, Family::Dnh, Family::Dnd}) add(family, main.order, frame);
  }
  return result;
}

}  // namespace

std::optional<ClassifiedGroup> classify(const std::vector<Matrix3d>& linear, double tolerance) {
  const Inventory have = take_inventory(linear, tolerance);
  if (have.proper == 0 || (have.improper != 0 && have.improper != have.proper)) return std::nullopt;
  for (const ClassifiedGroup& candidate : candidates(have, 8 * tolerance)) {
    if (reproduces(candidate, linear, 8 * tolerance)) return candidate;
  }
  return std::nullopt;
}

}  // namespace orbifit
