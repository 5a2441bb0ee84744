#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"

#include "basis/lift.h"
#include "deformation/corotation.h"

namespace orbifit::benchmarks {

/// What symmetry asks of the samples: u(sample) = frame u(seed) + sum over the pairs of matrix * t_carrier, where the
/// translations t carry groups that float. Without a sample the right side is to vanish.
struct SymmetryPair {
  int sample = -1;
  int seed = 0;
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  std::vector<std::pair<int, Eigen::Matrix3d>> carried;
};

/// A sampling with its symmetries as least squares see them.
struct SoftSampling {
  Points points;      ///< #S by 3
  double radius = 0;  ///< r, mesh units
  std::vector<SymmetryPair> pairs;
  int carriers = 0;  ///< translations t
};

/// What the subspace is compared with: co-rotated Laplace editing (paper, section 6) on the full sampling, 3#S unknowns
/// and the translations that carry floating groups. Symmetry is asked for by least squares instead:
/// weight * |u(g p) - O u(p) - (I - O) t|^2 for each pair.
class SoftSymmetry {
 public:
  /// Assembles the Laplace energy and the penalty.
  /// \param weight of the penalty, >= 0; 0: no symmetry
  SoftSymmetry(const SoftSampling& sampling, double weight);

  /// Factorises L^T L + weight C^T C + alpha A^T W A by sparse Cholesky.
  /// \param rows    A, #H by #S, displacements of the handles' points from those of the samples
  /// \param weights diagonal of W, #H
  /// \throw NoResultError where the system cannot be factorised
  void set_handles(const LiftWeights& rows, const Eigen::VectorXd& weights, double alpha);

  /// The samples' displacements, #S by 3, after so many iterations from the rest pose.
  /// \param targets of the handles' points, #H by 3
  Points solve(const Points& targets, int iterations);

  /// The largest |u(g p) - O u(p) - (I - O) t| that the last solve() left, mesh units.
  double symmetry_residual() const;

  Eigen::Index unknowns() const { return penalty_.cols(); }
  Eigen::Index non_zeros() const { return energy_.nonZeros(); }

 private:
  Corotation corotation_;
  Eigen::SparseMatrix<double> penalty_;  ///< C, three rows a constraint
  Eigen::SparseMatrix<double> energy_;   ///< L^T L on each coordinate, + weight C^T C
  Eigen::SparseMatrix<double> handle_rows_;
  Eigen::VectorXd handle_weights_;
  double alpha_ = 0;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
  Eigen::VectorXd solution_;
};

}  // namespace orbifit::benchmarks
