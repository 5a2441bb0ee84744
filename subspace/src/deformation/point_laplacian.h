#pragma once

#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"

#include "deformation/laplacian.h"

namespace orbifit {

/// Laplacian of samples as a point cloud (Belkin, Sun and Wang 2009; Liu, Prabhakaran and Guo 2012): neighbours i, j
/// count by a_i a_j exp(-|p_i - p_j|^2 / (h_i h_j)), with h_i the median distance of i's neighbours and a_i the area of
/// surface for which sample i stands, from the density of the samples about it. Weights depend on distances alone, so
/// the matrix has all symmetries of the samples; local scales h_i suit samplings of varying density. No edge counts
/// less than a hundredth of what it would at distance 0, so what the edges hold together stays so.
/// The mean diagonal is that of the graph Laplacian, so that the same stiffness means the same with either.
/// \param samples #S by 3
/// \param edges   of neighbour_graph()
/// \return #S by #S, symmetric, positive semi-definite, null space the constants when the edges connect all samples
Eigen::SparseMatrix<double> point_laplacian(const Points& samples, const SampleEdges& edges);

}  // namespace orbifit
