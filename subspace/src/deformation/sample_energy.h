#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "basis/lift.h"
#include "deformation/contact_energy.h"
#include "deformation/corotation.h"

namespace orbifit {

/// How displacements start to change as the groups turn: of the samples, of the Laplace coordinates asked for, and of
/// the handles' points about the samples that they follow. Columns by ways of turning.
struct Turning {
  Eigen::MatrixXd samples, along, arms;
};

/// The energy |L u - b|^2 + alpha |A u - a|_W^2 over displacements u = columns z + offset, and the contacts'.
class SampleEnergy {
 public:
  using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  /// \param points  A, handles' points by samples \param weights  W, of the points
  SampleEnergy(const Corotation& corotation, const LiftWeights& points, const std::vector<double>& weights,
               double alpha);

  struct Solution {
    Eigen::VectorXd z;  ///< the last unknowns are turns, radians
    double energy = 0;
  };

  /// \param laplace  b \param targets  a
  /// \throw NoResultError  the system cannot be factorised
  Solution solve(const SparseRows& columns, const Turning& turning, const Eigen::VectorXd& offset,
                 const Eigen::VectorXd& laplace, const Eigen::VectorXd& targets, const ContactRows& contacts) const;

 private:
  struct Part {
    SparseRows rows;
    Eigen::MatrixXd turns;
    Eigen::VectorXd right;
  };

  SparseRows laplacian_, points_;  // by coordinates, the points weighted
  Eigen::VectorXd weights_;
};

}  // namespace orbifit
