#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"

#include "deformation/corotation.h"
#include "deformation/neighbour_sums.h"

namespace orbifit {

/// The fit's regularisation of the samples' displacements u, co-rotated, per sample and neighbour, so that its weight
/// means the same on every sampling: |L u + (1 - R) delta|^2 / degree^2 + stretch / degree * edges' stretching.
class CorotatedEnergy {
 public:
  using Rotations = std::vector<Eigen::Matrix3d>;

  /// \param samples #S by 3 \param radius r of the sampling: samples nearer than 2 r are neighbours
  /// \param moved  #S by 3, a displacement that costs nothing, u being counted from there; no rows: none
  /// \param anchor  weight of |u|^2 of each sample
  CorotatedEnergy(const Points& samples, double radius, double stretch, const Points& moved = Points(0, 3),
                  double anchor = 0);

  Eigen::Index samples() const { return corotation_.rest.rows(); }

  /// K, #S by #S: the energy's quadratic part is u^T (K (x) I_3) u.
  Eigen::SparseMatrix<double> matrix() const;

  /// Half its linear part, #S by 3, as turned now: K u = pull where the energy is least.
  Points pull() const;

  /// Its value as turned now. \param displacements u, #S by 3
  double value(const Points& displacements) const;

  /// Of all stretched alike: the value at u = g x, unturned, is this times g^2.
  double of_growth() const;

  /// Turns the Laplace coordinates to the displacements.
  void rotate(const Points& displacements);

  const Rotations& rotations() const { return rotations_; }
  void set_rotations(const Rotations& rotations) { rotations_ = rotations; }

 private:
  Corotation corotation_;
  NeighbourSums sums_;
  double degree_;
  double stretch_;
  double anchor_;
  Rotations rotations_;
};

}  // namespace orbifit
