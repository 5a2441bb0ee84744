#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/baselines/full_sampling.h"
#include "orbifit/subspace/subspace.h"

#include "basis/lift.h"
#include "saddle_system.h"
#include "solver/deformation_system.h"

namespace orbifit {

/// The fit's linear system on the full sampling. Unknowns q = (u, t): displacements of all samples, stacked, and where
/// symmetry is used the translations that carry groups. Its |q|^2 counts each orbit once where symmetry is used, as the
/// subspace's coordinates do; it differs from theirs in the coordinates that carry groups.
class FullSystem final : public DeformationSystem {
 public:
  /// \param subspace of the paper's lift; its sampling, constraints and lift are used, not its basis. References are
  /// kept \param weight of soft symmetry: see FullSamplingOptions
  FullSystem(const Subspace& subspace, const Mesh& mesh, double stretch, FullSymmetry symmetry, double weight);

  Solution solve(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                 const std::vector<Pull>& pulls, const Hold& hold, const RunContext& context) override;
  Points samples_at(const Eigen::VectorXd& q) const override;
  Points vertices_at(const Eigen::VectorXd& q, const RunContext& context) const override;
  Eigen::Index unknowns() const override { return unknowns_; }
  double condition() const override { return saddle_.condition(); }
  double symmetry_energy(const Eigen::VectorXd& q) const override;

 private:
  using Sparse = Eigen::SparseMatrix<double>;

  // The sum of w (row x - right)^2 as x^T matrix x - 2 side^T x and a constant; matrix in blocks, the pose last.
  struct Normal {
    Sparse sparse;  // lower half
    Eigen::MatrixXd border;
    Eigen::MatrixXd corner;
    Eigen::VectorXd side;
  };
  class Batch;
  void couple(const std::vector<Correspondence>& pairs, const std::vector<Pull>& pulls);
  void normal_of(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                 const std::vector<Pull>& pulls, Normal& normal);

  const Mesh& mesh_;
  LiftWeights weights_;
  std::vector<int> nearest_;  // of each vertex, the sample that weighs most
  double diagonal_;
  Eigen::Vector3d pivot_;
  Sparse constraints_;  // C; no rows without symmetry
  Sparse penalty_;      // lower half, soft
  double soft_weight_ = 0;
  Eigen::Index unknowns_;
  Eigen::VectorXd metric_;                  // of |q|^2
  Eigen::MatrixXd rigid_;                   // rigid_modes() of the samples
  Sparse stiffness_;                        // lower half
  std::vector<std::vector<bool>> coupled_;  // by pairs of samples, the lower first: which data rows have met
  std::vector<char> known_;                 // faces whose samples are coupled
  Sparse data_;                             // lower half: the pattern that follows
  SaddleSystem saddle_;
};

}  // namespace orbifit
