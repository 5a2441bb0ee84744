#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/fitting/correspondences.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/corotation.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// A vertex and the place, in the template's frame, to which it is pulled.
struct Pull {
  int vertex;
  Eigen::Vector3d target;
  double weight;
};

/// The linear system of one iteration of the fit in the unknowns (q, omega, tau): coordinates in the subspace, and a
/// small rotation (times the template's diagonal) and translation that move the scan in the template's frame.
class FitSystem {
 public:
  FitSystem(const Subspace& subspace, const Mesh& mesh, double stretch);

  struct Solution {
    Eigen::VectorXd q;
    Motion scan_step;  ///< to apply to the scan in the template's frame
    double energy = 0;
  };

  /// Minimises stiffness (|L u + (1 - R) delta|^2 + stretch * edges' stretching) / degree^2
  ///           + sum of w <n, x + u - (s + omega x (s - c) + tau)>^2 (weights scaled to #S in all) + pulls.
  Solution solve(const std::vector<Correspondence>& pairs, const Points& scan_points, const std::vector<Pull>& pulls,
                 double stiffness, const RunContext& context);

  /// Turns the Laplace coordinates to the deformation q.
  void rotate(const Eigen::VectorXd& q);

  const Points& samples() const { return corotation_.rest; }

 private:
  // The sum of w (row x - right)^2 as x^T matrix x - 2 side^T x + constant.
  struct Normal {
    Eigen::MatrixXd matrix;  ///< lower half
    Eigen::VectorXd side;
    double constant;

    void add(const Eigen::RowVectorXd& row, double right, double weight, std::vector<int>& entries);
  };
  Normal normal_of(const std::vector<Correspondence>& pairs, const Points& scan_points, const std::vector<Pull>& pulls,
                   const RunContext& context) const;

  const Subspace& subspace_;
  const Mesh& mesh_;
  double diagonal_;
  Eigen::Vector3d pivot_;
  Corotation corotation_;
  double stretch_;
  Eigen::MatrixXd stiffness_matrix_;
  std::vector<Eigen::Matrix3d> rotations_;
};

}  // namespace orbifit
