#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "basis/conjugated_regions.h"
#include "basis/lift.h"
#include "basis/subspace_parts.h"
#include "deformation/contact_energy.h"
#include "solver/data_normal.h"
#include "solver/deformation_system.h"
#include "solver/normal_solver.h"
#include "solver/vertex_rows.h"

namespace orbifit {

/// The linear system of one iteration of a fit whose regions' groups turn (mode moving; docs/method.md 2.2): legs that
/// splay. To first order in the turns; then these are applied exactly, the basis is built anew, and its coordinates are
/// those nearest to what was solved for, so that every state keeps every carried symmetry to rounding.
///
/// q is the coordinates followed by the turns, the nine entries of one matrix a family (ConjugatedRegions::Turns).
class MovingSystem final : public DeformationSystem {
 public:
  /// References are kept. \param subspace  of mode moving \param contacts  as of FitSystem
  MovingSystem(const Subspace& subspace, const Mesh& mesh, double stretch, std::vector<Contact> contacts = {},
               const RunContext& context = RunContext{});

  /// Groups as at rest, at these coordinates of the subspace's own basis.
  Eigen::VectorXd at_rest(const Eigen::VectorXd& coordinates) const;

  SubspaceState state_of(const Eigen::VectorXd& q) const;

  /// Whether any group may turn.
  bool turns() const { return regions_.freedom() > 0; }

  /// \pre hold.around is where the fit is: the system is linearised there
  Solution solve(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                 const std::vector<Pull>& pulls, const Hold& hold, const RunContext& context) override;
  Points samples_at(const Eigen::VectorXd& q) const override;
  Points vertices_at(const Eigen::VectorXd& q, const RunContext& context) const override;
  Eigen::Index unknowns() const override { return subspace_.degrees_of_freedom() + regions_.freedom(); }
  double condition() const override;
  double contact_energy(const Eigen::VectorXd& q) const override;

 private:
  ConjugatedRegions::Turns turns_of(const Eigen::VectorXd& q) const;
  std::shared_ptr<const ConjugatedBasis> basis_at(const ConjugatedRegions::Turns& turns) const;
  // Turned by the angles, at the coordinates there that bring the samples nearest to these displacements; none where
  // groups turned so no longer agree.
  Eigen::VectorXd turned(const Eigen::VectorXd& q, const Eigen::VectorXd& angles, const Points& displacements) const;

  // Where the fit is, and how the samples start to move from there as the groups turn.
  struct Linearised {
    SubspaceState now;
    ConjugatedRegions::Turns turns;
    Points moved;  // displacements of the samples
    Mesh deformed;
    Eigen::MatrixXd turn_columns;  // 3#S by the ways in which groups may turn
  };
  Linearised linearised(const Eigen::VectorXd& q, const RunContext& context) const;
  VertexRows rows_at(const Linearised& at, const std::vector<int>& touched, const RunContext& context) const;
  void add_regularity(const Linearised& at, double stiffness, NormalEquations& normal) const;
  void add_contacts(const Linearised& at, double stiffness, NormalEquations& normal) const;
  void add_holds(const Linearised& at, double damping, NormalEquations& normal) const;
  // By increments of the coordinates and angles, of which no more than are small are made.
  Eigen::VectorXd moved_by(Eigen::VectorXd change, const Linearised& at, const Eigen::VectorXd& around) const;

  const Subspace& subspace_;
  const Mesh& mesh_;
  std::vector<Contact> contacts_;
  ConjugatedRegions regions_;
  Eigen::SparseMatrix<double> stiffness_;  // K, of the samples
  Eigen::MatrixXd rigid_;                  // rigid_modes() of the samples
  ScanStep step_;
  struct KnownBasis {
    ConjugatedRegions::Turns turns;
    std::shared_ptr<const ConjugatedBasis> basis;
  };
  mutable std::vector<KnownBasis> known_;  // of those that were asked for last, the last one last
  NormalSolver solver_;                    // of the last system
};

}  // namespace orbifit
