#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/motion.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// The step of a row, an arc or a screw, which can be taken in part: a translation, or a turn about an axis with a
/// shift along it.
class RowStep {
 public:
  explicit RowStep(const Motion& motion);

  /// Whether it is a rotation or translation, no reflection.
  bool proper() const { return turn_.determinant > 0; }
  bool turns() const { return turn_.angle > 1e-9; }

  /// How many places there are before a turn without shift comes back; `most` where there are more or it never does.
  int places(int most) const;

  Motion times(double share) const;

 private:
  Motion motion_;
  AxisAngle turn_;
  double pitch_ = 0;
  Eigen::Vector3d point_ = Eigen::Vector3d::Zero();  // of the axis
};

/// The step that best carries some faces from their place to each of those after it: point-to-plane least squares with
/// Tukey's loss over the places together, so that what is a little off from one to the next does not add up to much.
/// A translation stays one, and so does a turn without shift.
/// \param faces at the first place \param places where the faces are, counted from the first, at least 2
/// \param tolerance a length: matches are sought within twice of it
RowStep refined_step(const PreparedMesh& prepared, const RowStep& start, const std::vector<int>& faces, int places,
                     double tolerance);

}  // namespace orbifit
