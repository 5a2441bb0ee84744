#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/fitting/correspondences.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/corotation.h"
#include "orbifit/subspace/subspace.h"

#include "pulls.h"
#include "vertex_rows.h"

namespace orbifit {

/// The linear system of one iteration of the fit in the unknowns (q, omega, tau): coordinates in the subspace, and a
/// small rotation (times the template's diagonal) and translation that move the scan in the template's frame.
class FitSystem {
 public:
  FitSystem(const Subspace& subspace, const Mesh& mesh, double stretch);

  struct Solution {
    Eigen::VectorXd q;
    Motion scan_step;  ///< to apply to the scan in the template's frame
  };

  /// What holds the solution besides the data.
  struct Hold {
    double stiffness = 1;  ///< of the Laplace energy, > 0
    double damping = 0;    ///< of a step away from `around`, relative to one sample's share of the data, >= 0
    Eigen::VectorXd around;
  };

  /// Minimises stiffness regularity(u) + sum of w <n, x + u - (s + omega x (s - c) + tau)>^2 + pulls
  ///           + damping (|q - around|^2 + |(omega, tau)|^2).
  /// \param share of a pair: factor of its weight
  Solution solve(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                 const std::vector<Pull>& pulls, const Hold& hold, const RunContext& context);

  /// |L u + (1 - R) delta|^2 / degree^2 + stretch / degree * edges' stretching, of the deformation q as turned now.
  double regularity(const Eigen::VectorXd& q) const;

  /// Turns the Laplace coordinates to the deformation q.
  void rotate(const Eigen::VectorXd& q);

  using Rotations = std::vector<Eigen::Matrix3d>;
  const Rotations& rotations() const { return rotations_; }
  void set_rotations(const Rotations& rotations) { rotations_ = rotations; }

  const Points& samples() const { return corotation_.rest; }

 private:
  // The sum of w (row x - right)^2 as x^T matrix x - 2 side^T x and a constant.
  struct Normal {
    Eigen::MatrixXd matrix;  ///< lower half
    Eigen::VectorXd side;
  };
  class Batch;
  Normal normal_of(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                   const std::vector<Pull>& pulls, const RunContext& context);

  const Subspace& subspace_;
  VertexRows rows_;
  const Mesh& mesh_;
  double diagonal_;
  Eigen::Vector3d pivot_;
  Corotation corotation_;
  double stretch_;
  Eigen::MatrixXd stiffness_matrix_;
  Rotations rotations_;
};

}  // namespace orbifit
