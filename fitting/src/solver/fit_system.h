#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

#include "deformation/contact_energy.h"
#include "registration/correspondences.h"
#include "solver/data_normal.h"
#include "solver/deformation_system.h"
#include "solver/normal_solver.h"
#include "solver/vertex_rows.h"

namespace orbifit {

/// The linear system of one iteration of the fit in the unknowns (q, omega, tau): coordinates in the subspace, and a
/// small rotation (times the template's diagonal) and translation that move the scan in the template's frame.
class FitSystem final : public DeformationSystem {
 public:
  /// References are kept. One system may serve one fit after another: what it knows of vertices stays.
  /// \param contacts  to be kept, of kContactWeight samples each times contact_share()
  /// \param reference  displacement of the samples, #S by 3, that costs nothing and from which the energy counts, held
  ///   there where nothing else says where samples go; no rows: the rest shape's, which nothing but its shape holds
  FitSystem(const Subspace& subspace, const Mesh& mesh, double stretch, std::vector<Contact> contacts = {},
            Points reference = Points(0, 3));

  Solution solve(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                 const std::vector<Pull>& pulls, const Hold& hold, const RunContext& context) override;
  Points samples_at(const Eigen::VectorXd& q) const override;
  Points vertices_at(const Eigen::VectorXd& q, const RunContext& context) const override;
  Eigen::Index unknowns() const override { return subspace_.degrees_of_freedom(); }
  double condition() const override;
  double contact_energy(const Eigen::VectorXd& q) const override;

  const std::vector<Contact>& contacts() const { return contacts_.contacts(); }
  const Subspace& subspace() const { return subspace_; }

 private:
  const Subspace& subspace_;
  VertexRows rows_;
  const Mesh& mesh_;
  ScanStep step_;
  ContactEnergy contacts_;
  Eigen::SparseMatrix<double> stiffness_matrix_;  // lower half
  Eigen::SparseMatrix<double> contact_matrix_;    // likewise
  Eigen::SparseMatrix<double> hold_matrix_;       // what holds coordinates that move nothing
  Eigen::MatrixXd rigid_;                         // what prefers the pose: its square is added
  Points reference_pull_;                         // of the energy towards the reference, unturned; no rows: none
  NormalSolver solver_;                           // of the last system
};

}  // namespace orbifit
