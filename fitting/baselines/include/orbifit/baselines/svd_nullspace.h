#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// Orthonormal columns that span the null space of C, by a dense singular value decomposition (Bokeloh, Wand, Koltun,
/// Seidel 2012): the right singular vectors, as eigenvectors of C^T C. Memory quadratic, time cubic in the columns of
/// C.
Eigen::MatrixXd svd_nullspace(const Eigen::SparseMatrix<double>& constraints);

/// A subspace whose basis is dense, from svd_nullspace() of its symmetry_constraints(): of the null space what moves
/// samples.
/// \pre no groups are turned, the lift is the paper's
Subspace with_svd_basis(const Subspace& subspace);

struct SvdNullspaceOptions {
  FitOptions fit;            ///< its subspace's lift is taken to be the paper's
  double alpha = 100;        ///< weight of handles where there is no scan, > 0
  int edit_iterations = 10;  ///< then, >= 1

  void validate() const;  ///< \throw UsageError
};

/// fit() from one start in that basis. A scan without points and with handles asks for an edit by those handles.
/// Times: "prepare", of which "null space", and "fit".
FitResult fit_svd_nullspace(const FitInput& input, const SvdNullspaceOptions& options, const RunContext& context);

}  // namespace orbifit
