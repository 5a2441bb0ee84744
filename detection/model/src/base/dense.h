#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

/// \file Dense decompositions that stand in many files, compiled once: each takes the compiler seconds. To include this
/// instead of Eigen's own headers changes nothing else.

namespace orbifit {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// An orthonormal basis, n by k, of what the columns of an n by k matrix span. \pre they are independent, k <= n
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& columns);

/// Of all x that minimise |matrix x - right|, the shortest, by complete orthogonal decomposition.
/// \param matrix m by n, of any rank \param right m by k: k problems \param threshold  pivots below this fraction of
/// the largest count as zero \return n by k
Eigen::MatrixXd shortest_solution(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right, double threshold);

/// The solution of a symmetric positive semidefinite system, n by n, by LDL^T. Not finite where the input is not.
Eigen::VectorXd solve_semidefinite(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);
Vector6d solve_semidefinite(const Matrix6d& matrix, const Vector6d& right);

}  // namespace orbifit

// NOLINTBEGIN(readability-redundant-declaration)
namespace Eigen {

extern template class JacobiSVD<MatrixXd>;
extern template class JacobiSVD<Matrix3d>;
extern template class SelfAdjointEigenSolver<Matrix3d>;
extern template SelfAdjointEigenSolver<Matrix3d>& SelfAdjointEigenSolver<Matrix3d>::compute(const EigenBase<Matrix3d>&,
                                                                                            int);
extern template class SelfAdjointEigenSolver<orbifit::Matrix6d>;
extern template SelfAdjointEigenSolver<orbifit::Matrix6d>& SelfAdjointEigenSolver<orbifit::Matrix6d>::compute(
    const EigenBase<orbifit::Matrix6d>&, int);
extern template class SelfAdjointEigenSolver<MatrixXd>;
extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&,
                                                                                            int);

}  // namespace Eigen
// NOLINTEND(readability-redundant-declaration)
