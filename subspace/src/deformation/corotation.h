#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"

#include "deformation/laplacian.h"

namespace orbifit {

/// The Laplace energy of a sampling and its co-rotation (paper, section 6): neighbours, L, and delta = L x.
struct Corotation {
  Points rest;                               ///< x, #S by 3
  std::vector<std::vector<int>> neighbours;  ///< #S, ascending
  Eigen::SparseMatrix<double> laplacian;     ///< L, #S by #S
  Points delta;                              ///< L x, #S by 3
};

/// Graph Laplacian with edges below `distance` (the paper's 2 r).
Corotation corotation(const Points& samples, double distance);

/// Neighbours by the edges and any symmetric Laplacian, #S by #S.
Corotation corotation(const Points& samples, const SampleEdges& edges, const Eigen::SparseMatrix<double>& laplacian);

/// For each sample the rotation that takes its rest neighbourhood nearest to its deformed one (Sorkine and Alexa 2007):
/// polar decomposition of the covariance. Directions that the neighbourhood leaves open follow `previous`.
std::vector<Eigen::Matrix3d> local_rotations(const Corotation& corotation, const Points& deformed,
                                             const std::vector<Eigen::Matrix3d>& previous);

/// The same from the neighbourhoods' covariances, in place. \param covariances  sum of (y_j - y_i) (x_j - x_i)^T of
/// each sample \param sizes  their traces at rest; 0 where there are no neighbours, which keeps the rotation
void turn_locally(std::vector<Eigen::Matrix3d> covariances, const std::vector<double>& sizes,
                  std::vector<Eigen::Matrix3d>& rotations);

/// L^T (R delta - L x), #S by 3: the right-hand side of equation (4) without the handles.
Points corotated_pull(const Corotation& corotation, const std::vector<Eigen::Matrix3d>& rotations);

/// |L (x + u) - R delta|^2.
double laplace_energy(const Corotation& corotation, const std::vector<Eigen::Matrix3d>& rotations,
                      const Points& displacements);

/// U^T (K (x) I_3) U for a symmetric K on the samples (#S by #S): DoF by DoF, both halves.
Eigen::SparseMatrix<double> restricted(const Eigen::SparseMatrix<double>& columns,
                                       const Eigen::SparseMatrix<double>& scalar);

/// Each of #S by 3 rows as three entries of a vector, x0 y0 z0 x1 ...
Eigen::VectorXd stacked(const Points& rows);

}  // namespace orbifit
