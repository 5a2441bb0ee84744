#include "patterns/row_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "surface/face_points.h"
#include "surface/thresholds.h"

namespace orbifit {

using Eigen::Vector3d;

namespace {

constexpr double kLevelPitch = 1e-3;  // a turn with less of a shift has none

}  // namespace

RowStep::RowStep(const Motion& motion) : motion_(motion), turn_(axis_angle(motion.linear)) {
  if (!turns()) return;
  pitch_ = turn_.axis.dot(motion.translation);
  // A point of the axis: (I - R) c = t across it.
  const Vector3d across = motion.translation - pitch_ * turn_.axis;
  const double cotangent = 1 / std::tan(turn_.angle / 2);
  point_ = 0.5 * (across + cotangent * turn_.axis.cross(across));
}

int RowStep::places(int most) const {
  if (!turns() || std::abs(pitch_) > kLevelPitch) return most;
  return std::min(most, static_cast<int>(std::lround(2 * std::numbers::pi / turn_.angle)));
}

Motion RowStep::times(double share) const {
  if (!turns()) return {Eigen::Matrix3d::Identity(), share * motion_.translation};
  Motion result = Motion::rotation(turn_.axis, share * turn_.angle, point_);
  result.translation += share * pitch_ * turn_.axis;
  return result;
}

RowStep refined_step(const PreparedMesh& prepared, const RowStep& start, const std::vector<int>& faces, int places,
                     double tolerance) {
  constexpr int kIterations = 4;
  constexpr std::size_t kMaxFaces = 300;
  constexpr int kMaxPlaces = 5;
  constexpr double kReach = 2;    // tolerances
  constexpr double kTiny = 1e-5;  // of a difference quotient
  const bool turns = start.turns();
  const Motion first = start.times(1);
  const bool level = turns && std::abs(axis_angle(first.linear).axis.dot(first.translation)) <= kLevelPitch;
  Vector3d centre = Vector3d::Zero();
  for (const int face : faces) centre += face_centroid(prepared, face) / static_cast<double>(faces.size());
  // A small turn and shift after the step.
  const auto changed = [&](const Motion& step, const Vector6d& by) {
    const double angle = by.head<3>().norm();
    Motion change{Eigen::Matrix3d::Identity(), by.tail<3>()};
    if (angle > 0) {
      change = Motion::rotation(by.head<3>() / angle, angle, centre);
      change.translation += by.tail<3>();
    }
    Motion result = change * step;
    if (level) {
      const Vector3d axis = axis_angle(result.linear).axis;
      result.translation -= axis.dot(result.translation) * axis;
    }
    return result;
  };
  const int count = std::min(places - 1, kMaxPlaces);
  const std::size_t looks = std::min(faces.size(), kMaxFaces);
  Motion step = first;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const RowStep now(step);
    std::array<RowStep, 6> others{now, now, now, now, now, now};
    for (int j = turns ? 0 : 3; j < 6; ++j) {
      others[static_cast<std::size_t>(j)] = RowStep(changed(step, kTiny * Vector6d::Unit(j)));
    }
    Matrix6d matrix = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    for (int i = 1; i <= count; ++i) {
      const int place = (places - 1) * i / count;
      const Motion motion = now.times(place);
      std::array<Motion, 6> moved;
      for (std::size_t j = 0; j < 6; ++j) moved[j] = others[j].times(place);
      for (std::size_t s = 0; s < looks; ++s) {
        const int face = faces[s * faces.size() / looks];
        const Vector3d point = face_centroid(prepared, face);
        const Vector3d normal = motion.linear * prepared.normals.row(face).transpose();
        const SurfaceIndex::Nearest near =
            prepared.index->nearest_facing(motion(point), normal, kNearNormals, kReach * tolerance, true);
        if (near.face < 0) continue;
        const Vector3d facing = prepared.normals.row(near.face);
        const double ratio = near.distance / (kReach * tolerance);
        const double weight = (1 - ratio * ratio) * (1 - ratio * ratio);
        Vector6d row = Vector6d::Zero();
        for (int j = turns ? 0 : 3; j < 6; ++j) {
          row[j] = facing.dot(moved[static_cast<std::size_t>(j)](point) - motion(point)) / kTiny;
        }
        matrix += weight * row * row.transpose();
        right -= weight * facing.dot(motion(point) - near.point) * row;
      }
    }
    if (!(matrix.trace() > 0)) break;
    matrix += 1e-9 * matrix.trace() * Matrix6d::Identity();
    step = changed(step, solve_semidefinite(matrix, right));
  }
  return RowStep(step);
}

}  // namespace orbifit
