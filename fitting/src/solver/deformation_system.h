#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "registration/correspondences.h"
#include "solver/corotated_energy.h"
#include "solver/pulls.h"

namespace orbifit {

/// The linear system of one iteration of the fit, whatever its unknowns q are: coordinates in a subspace, displacements
/// of the samples ... Besides q it has a small rotation and translation that move the scan in the template's frame, and
/// where that is open, and the system knows of it, the template's scale.
class DeformationSystem {
 public:
  struct Solution {
    Eigen::VectorXd q;
    Motion scan_step;                 ///< to apply to the scan in the template's frame
    std::vector<Motion> other_steps;  ///< of the scans but the first, to apply before that
    /// Of the template about its centre, after that; q is in units of the grown template.
    double growth = 1;
  };

  /// What holds the solution besides the data.
  struct Hold {
    double stiffness = 1;  ///< of the Laplace energy, > 0
    double damping = 0;    ///< of a step away from `around`, relative to one sample's share of the data, >= 0
    Eigen::VectorXd around;
    bool scale_open = false;  ///< whether the template may grow, in systems that know of it
    double grown = 0;         ///< logarithm of the growth so far
    int other_scans = 0;      ///< how many have motions of their own
  };

  DeformationSystem(const DeformationSystem&) = delete;
  DeformationSystem& operator=(const DeformationSystem&) = delete;
  virtual ~DeformationSystem() = default;

  /// Minimises stiffness (regularity(q) + growth_cost(grown + gamma)) + symmetry_energy(q)
  ///           + contact_share(stiffness) contact_energy(q)
  ///           + sum of w <n, x + gamma (x - c) + u - (s + omega x (s - c) + tau)>^2 + pulls
  ///           + damping (|q - around|^2 + |(gamma, omega, tau)|^2)
  ///           + a millionth of the rigid part of all samples' displacements, squared, which prefers the pose to a
  ///           deformation that does the same.
  /// \param share of a pair: factor of its weight
  /// \throw NoResultError where there is no finite solution
  virtual Solution solve(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                         const std::vector<Pull>& pulls, const Hold& hold, const RunContext& context) = 0;

  virtual Points samples_at(const Eigen::VectorXd& q) const = 0;  ///< their displacements, #S by 3
  virtual Points vertices_at(const Eigen::VectorXd& q, const RunContext& context) const = 0;  ///< the same, #V by 3
  virtual Eigen::Index unknowns() const = 0;                                                  ///< without the pose

  /// Estimate of the 2-norm condition number of the system that was solved last. \pre solve()
  virtual double condition() const = 0;

  /// What a system that does not keep the symmetries exactly adds for them.
  virtual double symmetry_energy(const Eigen::VectorXd&) const { return 0; }

  /// What it adds, times contact_share(), for parts that are to go on touching, as turned now.
  virtual double contact_energy(const Eigen::VectorXd&) const { return 0; }

  /// CorotatedEnergy::value() of the deformation q.
  double regularity(const Eigen::VectorXd& q) const { return energy_.value(from_reference(q)); }

  /// What a growth of the template costs: as much as if it were stretched so. \param grown  its logarithm
  double growth_cost(double grown) const { return energy_.of_growth() * grown * grown; }

  /// Turns the Laplace coordinates to the deformation q.
  void rotate(const Eigen::VectorXd& q) { energy_.rotate(from_reference(q)); }

  using Rotations = CorotatedEnergy::Rotations;
  const Rotations& rotations() const { return energy_.rotations(); }
  void set_rotations(const Rotations& rotations) { energy_.set_rotations(rotations); }
  void unturn() { set_rotations(Rotations(rotations().size(), Eigen::Matrix3d::Identity())); }

  Eigen::Index samples() const { return energy_.samples(); }

 protected:
  /// \param reference  displacement of the samples from which the energy counts, #S by 3; no rows: none
  explicit DeformationSystem(CorotatedEnergy energy, Points reference = Points(0, 3))
      : energy_(std::move(energy)), reference_(std::move(reference)) {}

  CorotatedEnergy energy_;
  Points reference_;

 private:
  Points from_reference(const Eigen::VectorXd& q) const {
    return reference_.rows() == 0 ? samples_at(q) : Points(samples_at(q) - reference_);
  }
};

/// How much firmer than the shape a joint is: with 1 in place of 10 parts come apart where a view misleads, with a
/// hundred a wheel that is smaller sticks in its arch and drags what no view sees along.
constexpr double kFirmJoint = 10;

/// Of kContactWeight what a contact weighs, relative to one sample's share of the data: that it touches is known of the
/// template, as its shape is, so data that ask for it part or slide the joint as they bend the shape. No firmer than
/// the data while these are to pull the whole template to its pose: a joint turns an iteration late.
constexpr double contact_share(double stiffness) {
  return std::min(1.0, kFirmJoint * stiffness);
}

/// Of the squared rigid part of the samples' displacements, relative to one sample's share of the data: see
/// DeformationSystem::solve(). Not of all of them: what no data hold would stay with the pose where the rest leaves it.
constexpr double kPreferPose = 1e-6;
/// Of all samples' share of |q|^2, likewise: coordinates that move nothing stay.
constexpr double kHoldStill = 1e-10;
/// Holds what of the pose the data do not determine, likewise.
constexpr double kHoldPose = 1e-9;

}  // namespace orbifit
