#include "soft_symmetry.h"

#include <algorithm>

#include "orbifit/model/errors.h"

namespace orbifit::benchmarks {

namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

// Keeps what nothing holds where it is: samples relative to the Laplace energy's diagonal, whatever the weight;
// translations relative to the penalty's, which is all that they appear in.
constexpr double kHold = 1e-12;

void add_block(Entries& entries, Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (block(i, j) != 0) entries.emplace_back(row + i, column + j, block(i, j));
    }
  }
}

Eigen::SparseMatrix<double> penalty_rows(const SoftSampling& sampling, Eigen::Index unknowns) {
  const Eigen::Index translations = 3 * sampling.points.rows();
  Entries entries;
  Eigen::Index row = 0;
  for (const SymmetryPair& pair : sampling.pairs) {
    if (pair.sample >= 0) add_block(entries, row, Eigen::Index{3} * pair.sample, Eigen::Matrix3d::Identity());
    add_block(entries, row, Eigen::Index{3} * pair.seed, -pair.frame);
    for (const auto& [carrier, matrix] : pair.carried) add_block(entries, row, translations + 3 * carrier, -matrix);
    row += 3;
  }
  Eigen::SparseMatrix<double> rows(row, unknowns);
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

// K (x) I_3, with as many more rows and columns of zeros as there are further unknowns.
Eigen::SparseMatrix<double> for_each_coordinate(const Eigen::SparseMatrix<double>& scalar, Eigen::Index unknowns) {
  Entries entries;
  entries.reserve(3 * static_cast<std::size_t>(scalar.nonZeros()));
  for (Eigen::Index k = 0; k < scalar.outerSize(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(scalar, k); entry; ++entry) {
      for (int c = 0; c < 3; ++c) entries.emplace_back(3 * entry.row() + c, 3 * entry.col() + c, entry.value());
    }
  }
  Eigen::SparseMatrix<double> result(unknowns, unknowns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace

SoftSymmetry::SoftSymmetry(const SoftSampling& sampling, double weight)
    : corotation_(corotation(sampling.points, 2 * sampling.radius)) {
  const Eigen::Index unknowns = 3 * sampling.points.rows() + 3 * sampling.carriers;
  penalty_ = penalty_rows(sampling, unknowns);
  const Eigen::SparseMatrix<double> bending = corotation_.laplacian.transpose() * corotation_.laplacian;
  const Eigen::SparseMatrix<double> symmetry = penalty_.transpose() * penalty_;
  Eigen::SparseMatrix<double> hold(unknowns, unknowns);
  hold.setIdentity();
  hold *= kHold * bending.diagonal().mean();
  for (Eigen::Index t = 3 * bending.rows(); t < unknowns; ++t) hold.coeffRef(t, t) *= 1 + weight;
  energy_ = for_each_coordinate(bending, unknowns) + weight * symmetry + hold;
}

void SoftSymmetry::set_handles(const LiftWeights& rows, const Eigen::VectorXd& weights, double alpha) {
  handle_rows_ = rows;
  handle_weights_ = weights;
  alpha_ = alpha;
  const Eigen::SparseMatrix<double> weighted = handle_weights_.asDiagonal() * handle_rows_;
  const Eigen::SparseMatrix<double> gram = handle_rows_.transpose() * weighted;
  const Eigen::SparseMatrix<double> system = energy_ + alpha * for_each_coordinate(gram, energy_.cols());
  factor_.compute(system);
  if (factor_.info() != Eigen::Success) throw NoResultError("the soft constraints' system could not be factorised");
}

Points SoftSymmetry::solve(const Points& targets, int iterations) {
  const Points handle_pull = alpha_ * (handle_rows_.transpose() * (handle_weights_.asDiagonal() * targets));
  std::vector<Eigen::Matrix3d> rotations(corotation_.neighbours.size(), Eigen::Matrix3d::Identity());
  Points displacements = Points::Zero(corotation_.rest.rows(), 3);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(energy_.cols());
    right.head(displacements.size()) = stacked(corotated_pull(corotation_, rotations) + handle_pull);
    solution_ = factor_.solve(right);
    displacements = Eigen::Map<const Points>(solution_.data(), displacements.rows(), 3);
    rotations = local_rotations(corotation_, corotation_.rest + displacements, rotations);
  }
  return displacements;
}

double SoftSymmetry::symmetry_residual() const {
  const Eigen::VectorXd left = penalty_ * solution_;
  if (left.size() == 0) return 0;
  return Eigen::Map<const Points>(left.data(), left.size() / 3, 3).rowwise().norm().maxCoeff();
}

}  // namespace orbifit::benchmarks
