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

// Least squares for the step that brings the faces at the first place onto the surface at the others.
class StepRefinement {
 public:
  StepRefinement(const PreparedMesh& prepared, const RowStep& start, const std::vector<int>& faces, int places,
                 double tolerance)
      : prepared_(prepared), faces_(faces), places_(places), reach_(kReach * tolerance), turns_(start.turns()) {
    const Motion first = start.times(1);
    level_ = turns_ && std::abs(axis_angle(first.linear).axis.dot(first.translation)) <= kLevelPitch;
    for (const int face : faces) centre_ += face_centroid(prepared, face) / static_cast<double>(faces.size());
  }

  struct NormalEquations {
    Matrix6d matrix = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
  };

  // A small turn and shift after the step; a level step stays level.
  Motion changed(const Motion& step, const Vector6d& by) const {
    const double angle = by.head<3>().norm();
    Motion change{Eigen::Matrix3d::Identity(), by.tail<3>()};
    if (angle > 0) {
      change = Motion::rotation(by.head<3>() / angle, angle, centre_);
      change.translation += by.tail<3>();
    }
    Motion result = change * step;
    if (level_) {
      const Vector3d axis = axis_angle(result.linear).axis;
      result.translation -= axis.dot(result.translation) * axis;
    }
    return result;
  }

  // Of the change that is to be made to the step.
  NormalEquations equations(const Motion& step) const {
    constexpr int kMaxPlaces = 5;
    const RowStep now(step);
    std::array<RowStep, 6> others{now, now, now, now, now, now};
    for (int j = first_unknown(); j < 6; ++j) {
      others[static_cast<std::size_t>(j)] = RowStep(changed(step, kTiny * Vector6d::Unit(j)));
    }
    NormalEquations result;
    const int count = std::min(places_ - 1, kMaxPlaces);
    for (int i = 1; i <= count; ++i) {
      const int place = (places_ - 1) * i / count;
      std::array<Motion, 6> moved;
      for (std::size_t j = 0; j < 6; ++j) moved[j] = others[j].times(place);
      add_place(now.times(place), moved, result);
    }
    return result;
  }

 private:
  static constexpr double kReach = 2;    // tolerances
  static constexpr double kTiny = 1e-5;  // of a difference quotient

  int first_unknown() const { return turns_ ? 0 : 3; }

  // The faces by the motion to a place, and by those of steps changed a little in each unknown.
  void add_place(const Motion& motion, const std::array<Motion, 6>& moved, NormalEquations& equations) const {
    constexpr std::size_t kMaxFaces = 300;
    const std::size_t looks = std::min(faces_.size(), kMaxFaces);
    for (std::size_t s = 0; s < looks; ++s) {
      const int face = faces_[s * faces_.size() / looks];
      const Vector3d point = face_centroid(prepared_, face);
      const Vector3d normal = motion.linear * prepared_.normals.row(face).transpose();
      const SurfaceIndex::Nearest near =
          prepared_.index->nearest_facing(motion(point), normal, kNearNormals, reach_, true);
      if (near.face < 0) continue;
      const Vector3d facing = prepared_.normals.row(near.face);
      const double ratio = near.distance / reach_;
      const double weight = (1 - ratio * ratio) * (1 - ratio * ratio);
      Vector6d row = Vector6d::Zero();
      for (int j = first_unknown(); j < 6; ++j) {
        row[j] = facing.dot(moved[static_cast<std::size_t>(j)](point) - motion(point)) / kTiny;
      }
      equations.matrix += weight * row * row.transpose();
      equations.right -= weight * facing.dot(motion(point) - near.point) * row;
    }
  }

  const PreparedMesh& prepared_;
  const std::vector<int>& faces_;
  int places_;
  double reach_;
  bool turns_;
  bool level_ = false;
  Vector3d centre_ = Vector3d::Zero();  // of the faces
};

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
  const StepRefinement refinement(prepared, start, faces, places, tolerance);
  Motion step = start.times(1);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    auto [matrix, right] = refinement.equations(step);
    if (!(matrix.trace() > 0)) break;
    matrix += 1e-9 * matrix.trace() * Matrix6d::Identity();
    step = refinement.changed(step, solve_semidefinite(matrix, right));
  }
  return RowStep(step);
}

}  // namespace orbifit
