#include "orbifit/subspace/symmetric_basis.h"

#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace orbifit {

namespace {

// Directions whose singular value is below this, relative to matrices of orthogonal entries, are free.
constexpr double kRank = 1e-7;

struct SeedSpace {
  Eigen::MatrixXd free;   // Z, 3 by 0..3, orthonormal: seeds' displacements that the stabiliser keeps
  Eigen::MatrixXd bound;  // -C_s^+ C_t, 3 by 3#regions: what the translations dictate; no columns for none
};

// The constraints of one orbit, C_s s + C_t t = 0.
struct OrbitConstraints {
  Eigen::MatrixXd seeds;         // rows by 3
  Eigen::MatrixXd translations;  // rows by 3#regions
};

void add_to(Eigen::MatrixXd& rows, Eigen::Index first, const Transport& transport, double sign) {
  for (const auto& [region, matrix] : transport.carried) rows.block<3, 3>(first, 3 * region) += sign * matrix;
}

// Splits one orbit's constraints into what binds its seed and what binds the translations alone; the latter are
// appended to `pure`.
SeedSpace solve_seed(const OrbitConstraints& constraints, std::vector<Eigen::RowVectorXd>& pure) {
  SeedSpace space;
  if (constraints.seeds.rows() == 0) {
    space.free = Eigen::Matrix3d::Identity();
    return space;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(constraints.seeds, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::VectorXd& values = svd.singularValues();
  Eigen::Index rank = 0;
  while (rank < values.size() && values[rank] > kRank) ++rank;
  space.free = svd.matrixV().rightCols(3 - rank);
  if (constraints.translations.cols() == 0) return space;
  const Eigen::MatrixXd rotated = svd.matrixU().transpose() * constraints.translations;
  space.bound = Eigen::MatrixXd::Zero(3, rotated.cols());
  for (Eigen::Index k = 0; k < rank; ++k) space.bound -= svd.matrixV().col(k) * rotated.row(k) / values[k];
  for (Eigen::Index k = rank; k < rotated.rows(); ++k) {
    if (rotated.row(k).norm() > kRank) pure.emplace_back(rotated.row(k));
  }
  return space;
}

// Orthonormal basis of {t : rows t = 0} as columns.
Eigen::MatrixXd null_space(const std::vector<Eigen::RowVectorXd>& rows, Eigen::Index columns) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns, columns);
  for (const Eigen::RowVectorXd& row : rows) gram += row.transpose() * row;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  Eigen::Index free = 0;
  while (free < columns && solver.eigenvalues()[free] < kRank) ++free;
  return solver.eigenvectors().leftCols(free);
}

}  // namespace

SymmetricBasis symmetric_basis(const SymmetricSampling& sampling, int regions, bool floating) {
  const Eigen::Index translations = floating ? 3 * Eigen::Index{regions} : 0;
  const auto orbits = static_cast<std::size_t>(sampling.orbits());

  std::vector<std::vector<const SymmetricSampling::Constraint*>> constraints_of(orbits);
  for (const auto& constraint : sampling.constraints) {
    constraints_of[static_cast<std::size_t>(constraint.orbit)].push_back(&constraint);
  }
  std::vector<SeedSpace> seeds(orbits);
  std::vector<Eigen::RowVectorXd> pure;
  for (std::size_t orbit = 0; orbit < orbits; ++orbit) {
    OrbitConstraints system;
    const auto rows = 3 * static_cast<Eigen::Index>(constraints_of[orbit].size());
    system.seeds = Eigen::MatrixXd::Zero(rows, 3);
    system.translations = Eigen::MatrixXd::Zero(rows, translations);
    for (std::size_t i = 0; i < constraints_of[orbit].size(); ++i) {
      const auto row = 3 * static_cast<Eigen::Index>(i);
      const auto& [number, left, right] = *constraints_of[orbit][i];
      system.seeds.middleRows<3>(row) = left.frame - right.frame;
      add_to(system.translations, row, left, 1);
      add_to(system.translations, row, right, -1);
    }
    seeds[orbit] = solve_seed(system, pure);
  }

  // What the translations alone do to the samples: B_k + O_k bound. Directions that move nothing are no freedom.
  Eigen::MatrixXd shift(0, 0);
  Eigen::MatrixXd carried = Eigen::MatrixXd::Zero(translations, 0);
  if (translations > 0) {
    const Eigen::MatrixXd allowed = null_space(pure, translations);
    Eigen::MatrixXd effect = Eigen::MatrixXd::Zero(3 * sampling.points.rows(), allowed.cols());
    Eigen::MatrixXd rows(3, translations);
    for (Eigen::Index k = 0; k < sampling.points.rows(); ++k) {
      const auto sample = static_cast<std::size_t>(k);
      const SeedSpace& seed = seeds[static_cast<std::size_t>(sampling.orbit_of_sample[sample])];
      const Transport& transport = sampling.transports[sample];
      rows.setZero();
      add_to(rows, 0, transport, 1);
      if (seed.bound.cols() > 0) rows += transport.frame * seed.bound;
      effect.middleRows<3>(3 * k) = rows * allowed;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(effect.transpose() * effect);
    const double scale = std::max(1.0, solver.eigenvalues().size() > 0 ? solver.eigenvalues().maxCoeff() : 1.0);
    Eigen::Index idle = 0;
    while (idle < solver.eigenvalues().size() && solver.eigenvalues()[idle] < kRank * scale) ++idle;
    const Eigen::MatrixXd moving = solver.eigenvectors().rightCols(allowed.cols() - idle);
    carried = allowed * moving;
    shift = effect * moving;
  }

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index column = 0;
  for (std::size_t orbit = 0; orbit < orbits; ++orbit) {
    const Eigen::MatrixXd& free = seeds[orbit].free;
    for (int k = sampling.first_sample[orbit]; k < sampling.first_sample[orbit + 1]; ++k) {
      const Eigen::MatrixXd block = sampling.transports[static_cast<std::size_t>(k)].frame * free;
      for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < free.cols(); ++j) {
          if (block(i, j) != 0) entries.emplace_back(3 * k + i, column + j, block(i, j));
        }
      }
    }
    column += free.cols();
  }
  for (Eigen::Index i = 0; i < shift.rows(); ++i) {
    for (Eigen::Index j = 0; j < shift.cols(); ++j) {
      if (shift(i, j) != 0) entries.emplace_back(i, column + j, shift(i, j));
    }
  }
  SymmetricBasis basis;
  basis.columns.resize(3 * sampling.points.rows(), column + shift.cols());
  basis.columns.setFromTriplets(entries.begin(), entries.end());
  basis.carried = Eigen::MatrixXd::Zero(translations, column + shift.cols());
  if (translations > 0) basis.carried.rightCols(shift.cols()) = carried;
  return basis;
}

}  // namespace orbifit
