#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/subspace/symmetric_sampling.h"

namespace orbifit {

/// A basis of the symmetry-preserving displacements of a sampling (paper, section 5; floating: method notes 2.2).
/// A coordinate vector q gives the samples' displacements U q, stacked x0 y0 z0 x1 ..., and the translations T q that
/// carry the regions' groups.
struct SymmetricBasis {
  /// U, 3#S by DoF. Columns of one orbit touch that orbit alone; the last ones, which move groups, touch many.
  Eigen::SparseMatrix<double> columns;
  /// T, 3#regions by DoF; no rows when groups are fixed.
  Eigen::MatrixXd carried;

  int degrees_of_freedom() const { return static_cast<int>(columns.cols()); }
};

/// The null space of the constraints in the orbits' seeds s and the translations t:
/// each orbit leaves 0 to 3 columns Z of its own, and t = T q couples orbits, s = Z q - C_s^+ C_t t.
/// Cost O(samples * regions they depend on + regions^3).
SymmetricBasis symmetric_basis(const SymmetricSampling& sampling, int regions, bool floating);

}  // namespace orbifit
