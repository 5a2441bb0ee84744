#include "resolution/transfer.h"

#include <vector>

#include "orbifit/model/errors.h"
#include "orbifit/subspace/displacement_field.h"

#include "basis/subspace_parts.h"
#include "deformation/corotation.h"
#include "solver/normal_solver.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

// The rows of the orbits' seeds.
Sparse seed_columns(const SymmetricSampling& sampling, const Sparse& columns) {
  const Eigen::SparseMatrix<double, Eigen::RowMajor> all(columns);
  std::vector<Eigen::Triplet<double>> entries;
  for (int orbit = 0; orbit < sampling.orbits(); ++orbit) {
    for (int c = 0; c < 3; ++c) {
      const Index row = 3 * Index{sampling.first_sample[static_cast<std::size_t>(orbit)]} + c;
      for (decltype(all)::InnerIterator it(all, row); it; ++it) {
        entries.emplace_back(3 * orbit + c, it.col(), it.value());
      }
    }
  }
  Sparse result(3 * Index{sampling.orbits()}, columns.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace

VectorXd transferred(const Subspace& from, const SubspaceState& state, const Subspace& to, const RunContext& context) {
  constexpr double kRidge = 1e-12;  // coordinates that move no sample stay
  const SymmetricSampling& sampling = to->sampling;
  const std::vector<int> seeds(sampling.first_sample.begin(), sampling.first_sample.end() - 1);
  std::vector<int> sets;
  for (const int seed : seeds) sets.push_back(sampling.sets[static_cast<std::size_t>(seed)]);
  const Points wanted = displacement_field(from, state, sampling.points(seeds, Eigen::all), sets, context);
  // The seeds and the translations that carry the groups determine all samples.
  const Sparse columns = seed_columns(sampling, to->basis.columns);
  const Sparse carriers = to->basis.carried.sparseView();
  Sparse gram = columns.transpose() * columns;
  VectorXd side = columns.transpose() * stacked(wanted);
  if (carriers.rows() > 0) {
    gram += Sparse(carriers.transpose() * carriers);
    side += carriers.transpose() * (basis_of(from, state).carried * state.q);
  }
  const VectorXd ridge = VectorXd::Constant(gram.cols(), kRidge * gram.diagonal().mean());
  gram = Sparse(gram.triangularView<Eigen::Lower>()) + Sparse(ridge.asDiagonal());
  NormalSolver solver;
  if (!solver.compute(gram, Eigen::MatrixXd(gram.cols(), 0))) {
    throw NoResultError("the coarse displacement cannot be written in the finer subspace");
  }
  return solver.solve(side);
}

}  // namespace orbifit
