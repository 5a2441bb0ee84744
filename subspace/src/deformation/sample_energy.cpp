#include "deformation/sample_energy.h"

#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "deformation/precise_sum.h"
#include "deformation/unsolvable.h"

namespace orbifit {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseRows = SampleEnergy::SparseRows;

constexpr double kHoldCoordinates = 1e-10;  // of the mean of the diagonal, on coordinates
constexpr double kHoldTurns = 1e-6;         // of a turn's own stiffness, and of the largest

// A (x) I_3.
SparseRows thrice(const SparseRows& scalar) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(3 * static_cast<std::size_t>(scalar.nonZeros()));
  for (Eigen::Index row = 0; row < scalar.rows(); ++row) {
    for (SparseRows::InnerIterator entry(scalar, row); entry; ++entry) {
      for (Eigen::Index c = 0; c < 3; ++c) entries.emplace_back(3 * row + c, 3 * entry.col() + c, entry.value());
    }
  }
  SparseRows result(3 * scalar.rows(), 3 * scalar.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

// Adds the lower half of rows^T rows. A row touches few coordinates: those of the samples near its own.
void add_lower_gram(const SparseRows& rows, Eigen::Ref<MatrixXd> gram) {
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    for (SparseRows::InnerIterator a(rows, row); a; ++a) {
      for (SparseRows::InnerIterator b = a; b; ++b) gram(b.col(), a.col()) += a.value() * b.value();
    }
  }
}

// rows^T (right - rows z) - hold z over all parts: what is left of the normal equations. In twice the digits, since
// these nearly cancel along what hardly anything but `hold` decides, such as a turn about the line of two handles.
template <class Parts>
VectorXd left_over(const Parts& parts, const VectorXd& hold, const VectorXd& z) {
  std::vector<PreciseSum> sums;
  for (Eigen::Index k = 0; k < z.size(); ++k) sums.emplace_back().add_product(-hold[k], z[k]);
  std::vector<std::pair<Eigen::Index, double>> entries;  // of a row
  for (const auto& part : parts) {
    const Eigen::Index turns = part.turns.cols(), rest = z.size() - turns;
    for (Eigen::Index row = 0; row < part.right.size(); ++row) {
      entries.clear();
      for (SparseRows::InnerIterator entry(part.rows, row); entry; ++entry) {
        entries.emplace_back(entry.col(), entry.value());
      }
      for (Eigen::Index t = 0; t < turns; ++t) entries.emplace_back(rest + t, part.turns(row, t));
      PreciseSum left(part.right[row]);
      for (const auto& [column, value] : entries) left.add_product(-value, z[column]);
      for (const auto& [column, value] : entries) sums[static_cast<std::size_t>(column)].add_product(value, left);
    }
  }
  VectorXd result(z.size());
  for (Eigen::Index k = 0; k < z.size(); ++k) result[k] = sums[static_cast<std::size_t>(k)].value();
  return result;
}

}  // namespace

SampleEnergy::SampleEnergy(const Corotation& corotation, const std::vector<double>& weights, double alpha,
                           const BoundedEdit& bound)
    : bound_(bound), laplacian_(thrice(corotation.laplacian)), weights_(3 * static_cast<Eigen::Index>(weights.size())) {
  for (Eigen::Index i = 0; i < weights_.size(); ++i) {
    weights_[i] = std::sqrt(alpha * weights[static_cast<std::size_t>(i / 3)]);
  }
}

SampleEnergy::Solution SampleEnergy::solve(const Terms& terms, const Turning& turning) const {
  const Eigen::Index rest = terms.basis.columns.cols();
  const Eigen::Index turns = turning.samples.cols();
  const HandlePoints& handles = terms.handles;
  const ContactRows& contacts = terms.contacts;
  const Part parts[] = {{laplacian_ * terms.basis.columns, laplacian_ * turning.samples - turning.along,
                         terms.laplace - laplacian_ * terms.basis.offset},
                        {weights_.asDiagonal() * handles.rows, weights_.asDiagonal() * turning.handles,
                         weights_.cwiseProduct(terms.targets - handles.offset)},
                        {contacts.rows.leftCols(rest).sparseView(), contacts.rows.rightCols(turns), contacts.right}};
  MatrixXd normal = MatrixXd::Zero(rest + turns, rest + turns);
  VectorXd side = VectorXd::Zero(rest + turns);
  VectorXd own;  // however firm contacts are, what holds the unknowns is measured by the rest
  for (const Part& part : parts) {
    if (&part == &parts[2]) own = normal.diagonal();
    add_lower_gram(part.rows, normal.topLeftCorner(rest, rest));
    normal.bottomLeftCorner(turns, rest) += part.turns.transpose() * part.rows;
    normal.bottomRightCorner(turns, turns) += part.turns.transpose() * part.turns;
    side.head(rest) += part.rows.transpose() * part.right;
    side.tail(turns) += part.turns.transpose() * part.right;
  }
  VectorXd hold(rest + turns);
  if (rest > 0) hold.head(rest).setConstant(kHoldCoordinates * own.head(rest).mean());
  if (turns > 0) {
    hold.tail(turns) = kHoldTurns * (own.tail(turns).array() + own.tail(turns).maxCoeff() + 1e-300).matrix();
  }
  normal.diagonal() += hold;
  const auto solution_of = [&] {
    const Eigen::LDLT<MatrixXd, Eigen::Lower> factor(normal);
    const VectorXd z = factor.solve(side);
    return VectorXd(z + factor.solve(left_over(parts, hold, z)));
  };
  Solution solution;
  solution.z = solution_of();
  if (bound_.exceeded(terms.basis.columns, solution.z.head(rest))) {
    double energy = 0;
    for (const Part& part : parts) energy += part.right.squaredNorm();
    const double weight = bound_.weight(terms.basis.columns, energy);
    hold.head(rest).array() += weight;
    normal.diagonal().head(rest).array() += weight;
    solution.z = solution_of();
  }
  if (!solution.z.allFinite()) refuse_unsolvable();
  for (const Part& part : parts) {
    solution.energy +=
        (part.rows * solution.z.head(rest) + part.turns * solution.z.tail(turns) - part.right).squaredNorm();
  }
  return solution;
}

double SampleEnergy::value(const Terms& terms, const VectorXd& z) const {
  const VectorXd moved = terms.handles.rows * z + terms.handles.offset;
  return (laplacian_ * (terms.basis.columns * z + terms.basis.offset) - terms.laplace).squaredNorm() +
         weights_.cwiseProduct(moved - terms.targets).squaredNorm() +
         (terms.contacts.rows * z - terms.contacts.right).squaredNorm();
}

}  // namespace orbifit
