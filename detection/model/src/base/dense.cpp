#include "base/dense.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace Eigen {

template class JacobiSVD<MatrixXd>;
template class JacobiSVD<Matrix3d>;
template class SelfAdjointEigenSolver<Matrix3d>;
template SelfAdjointEigenSolver<Matrix3d>& SelfAdjointEigenSolver<Matrix3d>::compute(const EigenBase<Matrix3d>&, int);
template class SelfAdjointEigenSolver<orbifit::Matrix6d>;
template SelfAdjointEigenSolver<orbifit::Matrix6d>& SelfAdjointEigenSolver<orbifit::Matrix6d>::compute(
    const EigenBase<orbifit::Matrix6d>&, int);
template class SelfAdjointEigenSolver<MatrixXd>;
template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, int);

}  // namespace Eigen

namespace orbifit {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd orthonormal_basis(const MatrixXd& columns) {
  return Eigen::HouseholderQR<MatrixXd>(columns).householderQ() * MatrixXd::Identity(columns.rows(), columns.cols());
}

MatrixXd shortest_solution(const MatrixXd& matrix, const MatrixXd& right, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver;
  solver.setThreshold(threshold);
  return solver.compute(matrix).solve(right);
}

VectorXd solve_semidefinite(const MatrixXd& matrix, const VectorXd& right) {
  return matrix.ldlt().solve(right);
}

Vector6d solve_semidefinite(const Matrix6d& matrix, const Vector6d& right) {
  return matrix.ldlt().solve(right);
}

}  // namespace orbifit
