#include "orbifit/baselines/svd_nullspace.h"

#include <memory>

#include "orbifit/baselines/symmetry_constraints.h"

#include "base/dense.h"
#include "baseline_fit.h"
#include "basis/subspace_parts.h"
#include "fit_trial.h"
#include "solver/fit_system.h"

namespace orbifit {

namespace {

constexpr double kFree = 3e-4;    // singular values below this: as symmetric_basis() sees them
constexpr double kMoving = 1e-6;  // share of a null vector that moves samples

}  // namespace

Eigen::MatrixXd svd_nullspace(const Eigen::SparseMatrix<double>& constraints) {
  const Eigen::Index columns = constraints.cols();
  if (constraints.rows() == 0) return Eigen::MatrixXd::Identity(columns, columns);
  // The right singular vectors are the eigenvectors of C^T C. Eigen's divide and conquer mixes them up where singular
  // values are many times the same, as they are here.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> svd(Eigen::MatrixXd(constraints.transpose() * constraints));
  return svd.eigenvectors().leftCols((svd.eigenvalues().array() < kFree * kFree).count());
}

Subspace with_svd_basis(const Subspace& subspace) {
  const Eigen::MatrixXd all = svd_nullspace(symmetry_constraints(subspace));
  const Eigen::Index moved = 3 * subspace->sampling.points.rows();
  const Eigen::MatrixXd gram = all.topRows(moved).transpose() * all.topRows(moved);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(gram);
  const Eigen::Index free = (spectrum.eigenvalues().array() > kMoving * kMoving).count();
  const Eigen::MatrixXd basis = all * spectrum.eigenvectors().rightCols(free);
  const auto parts = std::make_shared<SubspaceParts>(*subspace);
  parts->basis.columns = basis.topRows(moved).sparseView(0, 0);
  parts->basis.carried = basis.bottomRows(basis.rows() - moved);
  parts->basis.atoms = parts->basis.columns;  // the plain lift's atoms are the samples
  return Subspace(parts);
}

void SvdNullspaceOptions::validate() const {
  fit.validate();
  validate_editing(alpha, edit_iterations);
}

FitResult fit_svd_nullspace(const FitInput& input, const SvdNullspaceOptions& options, const RunContext& context) {
  options.validate();
  FitResult result;
  StageClock clock(result.times);
  PlacedScan start;
  const bool edit = by_handles_alone(input);
  if (!edit) start = baseline_start(input, options.fit, context);
  const Subspace own = plain_subspace(input, options.fit, context);
  StageClock of_basis(result.times);
  const Subspace subspace = with_svd_basis(own);
  of_basis.finished("null space");
  if (edit) {
    result.pose = input.pose;
    edit_in_subspace(subspace, input, options.alpha, options.edit_iterations, context, clock, result);
  } else {
    FitSystem system(subspace, input.mesh, options.fit.stretch);
    clock.finished("prepare");
    run_fit(system, {start.pose, Eigen::VectorXd::Zero(system.unknowns())}, 0, input, start, options.fit, context,
            result);
  }
  clock.finished("fit");
  result.samples = static_cast<int>(subspace->sampling.points.rows());
  result.degrees_of_freedom = subspace.degrees_of_freedom();
  finish_baseline(input, options.fit, vertex_displacements(subspace, {result.q, nullptr}, context),
                  edit ? nullptr : &start, context, result);
  carry_annotation(input, &subspace, subspace->basis.carried * result.q, result);
  return result;
}

}  // namespace orbifit
