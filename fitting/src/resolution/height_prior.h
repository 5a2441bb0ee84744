#pragma once

#include <functional>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// A mesh with one place for each orbit of its vertices (VertexOrbits).
struct QuotientSurface {
  Eigen::SparseMatrix<double, Eigen::RowMajor> stiffness;  ///< #R by #R: cotangents, over all images
  Eigen::VectorXd areas;   ///< #R: of all vertices of the orbit, mesh units squared, > 0
  Eigen::VectorXd images;  ///< #R: at how many places it has vertices, >= 1

  /// O(V log V) \param mesh  of which the subspace is, wherever its vertices are now
  QuotientSurface(const Subspace& subspace, const Mesh& mesh);
};

/// Gaussian heights of a standard deviation over a quotient surface, alike over a length (Whittle 1963; Lindgren, Rue
/// and Lindstroem 2011; docs/method.md 7.1): the precision P is S^T W S.
struct HeightPrior {
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  Sparse root;              ///< S, #R by #R, symmetric, positive definite
  Eigen::VectorXd weights;  ///< W, #R, > 0

  /// \param deviation, length  mesh units, > 0
  HeightPrior(const QuotientSurface& quotient, double deviation, double length);

  Eigen::VectorXd precision_times(const Eigen::VectorXd& heights) const;
};

/// x of (A + P) x = side by conjugate gradients. What A says, lumped onto the diagonal, makes a preconditioner as
/// sparse as the surface: (S + (D / W)^1/2)^T W (S + (D / W)^1/2) is P + D up to a factor near 1 (Pearson and Wathen
/// 2012).
/// \param known  D, #R, >= 0 \param times  x -> (A + P) x
/// \throw NoResultError where that cannot be factorised
Eigen::VectorXd solve_with_prior(const HeightPrior& prior, const Eigen::VectorXd& known,
                                 const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& times,
                                 const Eigen::VectorXd& side, const RunContext& context);

}  // namespace orbifit
