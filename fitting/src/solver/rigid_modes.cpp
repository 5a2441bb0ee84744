#include "solver/rigid_modes.h"

#include <Eigen/Geometry>
#include <Eigen/QR>

namespace orbifit {

Eigen::MatrixXd rigid_modes(const Points& points) {
  constexpr double kNegligible = 1e-9;  // relative: a turn that moves the points no farther is none
  const Eigen::RowVector3d middle = points.colwise().mean();
  const Points arms = points.rowwise() - middle;
  const double size = arms.rowwise().norm().maxCoeff();
  Eigen::MatrixXd motions(3 * points.rows(), 6);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Vector3d arm = size > 0 ? Eigen::Vector3d(arms.row(i).transpose() / size) : Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(c);
      motions.block<3, 1>(3 * i, c) = axis;
      motions.block<3, 1>(3 * i, 3 + c) = axis.cross(arm);
    }
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(motions);
  factor.setThreshold(kNegligible);
  return factor.householderQ() * Eigen::MatrixXd::Identity(motions.rows(), factor.rank());
}

}  // namespace orbifit
