#pragma once

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/subspace/corotation.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/laplacian.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// What a solve did.
struct Deformation {
  Eigen::VectorXd q;        ///< coordinates in the subspace, DoF
  double energy = 0;        ///< E_L + alpha E_C at the end (paper, equation 3)
  double handle_error = 0;  ///< root mean square distance of the handles' vertices from their targets, mesh units
  double last_change = 0;   ///< largest movement of a sample in the last iteration, mesh units
};

/// Iterative co-rotated Laplace editing in the symmetric subspace (paper, section 6). Factorise once for a set of
/// handles, solve many times for where they go.
class Deformer {
 public:
  /// \param subspace and mesh outlive the deformer
  Deformer(const Subspace& subspace, const Mesh& mesh);

  /// Factorises U^T (L^T L + alpha A^T A) U (equation 4). A has a row for each vertex of a handle, weighted so that a
  /// handle counts as the samples near it, however finely it is tessellated.
  void set_handles(const std::vector<Handle>& handles, double alpha);

  /// Where the handles shall go: one motion for each, in the order of set_handles().
  /// \param start coordinates to start from (their rotations are used), or empty for the rest pose
  Deformation solve(const std::vector<Motion>& motions, int iterations, const Eigen::VectorXd& start = {}) const;

 private:
  Points handle_targets(const std::vector<Motion>& motions) const;

  const Subspace& subspace_;
  const Mesh& mesh_;
  Corotation corotation_;
  Eigen::MatrixXd stiffness_;  ///< U^T L^T L U
  std::vector<Handle> handles_;
  LiftWeights handle_lift_;  ///< rows of the lift at the handles' vertices
  Eigen::VectorXd handle_weights_;
  double alpha_ = 0;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace orbifit
