#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "block_matrix.h"
#include "kurz_terms.h"

namespace orbifit {

/// The normal equations of KurzTerms. All that is quadratic in the scalar basis functions is multiplied out once: an
/// iteration adds the data and, where symmetries were turned, weighs the mixed products anew.
class KurzNormal {
 public:
  /// \param terms kept by reference; weights may change, what they weigh may not
  KurzNormal(const KurzTerms& terms, const Eigen::SparseMatrix<double>& plate);

  /// The minimum of the energy for the rotations of `state`, whose nodes and carriers are replaced.
  /// \throw NoResultError where the matrix is not positive definite to rounding
  void solve(const DataTerm& data, KurzState& state);

  double condition() const { return matrix_.condition(); }

 private:
  void add_constant();
  void add_symmetry(const KurzState& state);
  void add_carriers(const SymmetryDemand& demand, const Eigen::Matrix3d& linear, std::size_t number);
  void hold_open_carriers();
  void add_data(const DataTerm& data);
  Eigen::VectorXd right_side(const DataTerm& data, const KurzState& state) const;

  const KurzTerms& terms_;
  Eigen::SparseMatrix<double> plate_;
  Eigen::SparseMatrix<double> diagonal_;            // sum over demands of w (B^T B + B_g^T B_g)
  std::vector<Eigen::SparseMatrix<double>> mixed_;  // of each demand w B_g^T B
  std::vector<Eigen::VectorXd> sums_, image_sums_;  // of each demand w B^T 1, w B_g^T 1
  Eigen::SparseMatrix<double> pulls_;               // B^T W B
  BlockMatrix matrix_;
  // What has not changed since: rotations and weights it was made for.
  BlockMatrix::Blocks constant_;
  std::vector<Eigen::Matrix3d> rotations_;
  double thin_plate_ = -1;
};

}  // namespace orbifit
