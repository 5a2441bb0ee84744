#pragma once

#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Neighbours among samples: pairs (i, j), i < j, ascending.
using SampleEdges = std::vector<std::pair<int, int>>;

/// Pairs of distinct points closer than `distance` (paper, section 6: 2 r). Where that leaves the points in several
/// pieces, the nearest pairs between pieces are added until they hang together, all pairs of the same distance at once,
/// so that the graph keeps the points' symmetries.
SampleEdges neighbour_graph(const Points& points, double distance);

/// The same for a sampling of varying radius: pairs closer than the sum of their radii, #S.
SampleEdges neighbour_graph(const Points& points, const Eigen::VectorXd& radii);

/// Degree matrix less adjacency matrix, #S by #S (paper, section 6).
Eigen::SparseMatrix<double> graph_laplacian(const SampleEdges& edges, Eigen::Index samples);

}  // namespace orbifit
