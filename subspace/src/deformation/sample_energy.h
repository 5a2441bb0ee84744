#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "basis/symmetric_basis.h"
#include "deformation/bounded_edit.h"
#include "deformation/contact_energy.h"
#include "deformation/corotation.h"

namespace orbifit {

/// How displacements start to change as the groups turn: of the samples, of the Laplace coordinates asked for, and of
/// the handles' points. Columns by ways of turning.
struct Turning {
  Eigen::MatrixXd samples, along, handles;
};

/// The handles' points move by rows z + offset, to first order of turns by Turning::handles besides.
struct HandlePoints {
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows;  ///< 3 #points by DoF
  Eigen::VectorXd offset;                             ///< 3 #points
};

/// The energy |L u - b|^2 + alpha |v - a|_W^2 over displacements u = columns z + offset of the samples and v of the
/// handles' points, and the contacts'.
class SampleEnergy {
 public:
  using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  /// \param weights  W, of the handles' points
  SampleEnergy(const Corotation& corotation, const std::vector<double>& weights, double alpha,
               const BoundedEdit& bound);

  struct Solution {
    Eigen::VectorXd z;  ///< the last unknowns are turns, radians
    double energy = 0;
  };

  /// What it is made of where the groups stand somewhere.
  struct Terms {
    const SymmetricBasis& basis;  ///< its columns and offset
    const HandlePoints& handles;
    Eigen::VectorXd laplace;         ///< b
    const Eigen::VectorXd& targets;  ///< a
    ContactRows contacts;
  };

  /// \throw NoResultError  the system cannot be factorised
  Solution solve(const Terms& terms, const Turning& turning) const;

  /// Of coordinates, without turns.
  double value(const Terms& terms, const Eigen::VectorXd& z) const;

 private:
  struct Part {
    SparseRows rows;
    Eigen::MatrixXd turns;
    Eigen::VectorXd right;
  };

  BoundedEdit bound_;
  SparseRows laplacian_;     // by coordinates
  Eigen::VectorXd weights_;  // square roots of what the points' coordinates weigh
};

}  // namespace orbifit
