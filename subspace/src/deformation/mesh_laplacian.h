#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "basis/lift.h"
#include "deformation/laplacian.h"

namespace orbifit {

/// Cotangent stiffness of a triangle mesh (Pinkall and Polthier 1993): u^T L u is the Dirichlet energy of the piecewise
/// linear u, twice over. #V by #V, symmetric, positive semi-definite, rows sum to 0 (the constants are in its null
/// space); (L x)_v is twice the mean curvature normal integrated about v, pointing outwards. The sum of one matrix a
/// triangle, so edges of any number of faces, doubled faces and borders need no care. A triangle of no area
/// contributes nothing; one whose cotangents exceed 1e4 is weighted down to that, as a whole, so that the matrix stays
/// semi-definite.
Eigen::SparseMatrix<double> cotangent_laplacian(const Mesh& mesh);

/// Area about each vertex, #V: the mixed Voronoi area of Meyer et al. 2003, whose sum is the mesh's area.
Eigen::VectorXd vertex_areas(const Mesh& mesh);

/// The same surface in triangles with no edge longer than `longest`: each triangle with a longer one is cut into n^2
/// similar ones, for itself, with vertices of its own. Vertices of the mesh come first and in their order.
/// \param longest mesh units, > 0; triangles are cut at most 256-fold along a side
Mesh tessellated(const Mesh& mesh, double longest);

/// The Galerkin restriction K = W^T L W of the cotangent stiffness to displacements u = W u_S of the vertices
/// (Huang et al. 2006, section 4, where the coarse mesh's mean values stand for W): #S by #S, symmetric, positive
/// semi-definite, the constants in its null space as rows of W sum to 1. u_S^T K u_S is the Dirichlet energy of the
/// lifted displacement, so it does not matter whether vertices at one place are one or many. It has the symmetries of
/// W and the surface.
/// \param weights #V by #S
/// \return O(sum over vertices of their squared number of weights)
Eigen::SparseMatrix<double> restricted_laplacian(const Mesh& mesh, const LiftWeights& weights,
                                                 const RunContext& context);

/// The matrix times the factor that makes its mean diagonal that of `model`, so that the same stiffness means the same
/// with either. A zero matrix stays so.
Eigen::SparseMatrix<double> scaled_like(const Eigen::SparseMatrix<double>& matrix,
                                        const Eigen::SparseMatrix<double>& model);

/// A Laplacian of the samples that knows the surface between them: `restricted_laplacian` of the surface, tessellated
/// so that no sample goes unseen, by partition-of-unity Gaussians of half the radius (as wide as the lift's they would
/// hardly see samples that go to and fro), scaled to the graph Laplacian's diagonal; of that one 2 % are added, which
/// keeps pieces together that the surface does not join. It stands in for the graph Laplacian L in
/// |L (x + u) - R delta|^2 (paper, section 6).
/// \param samples #S by 3, an r-sampling of the mesh
/// \param radius  r, mesh units, > 0
/// \param edges   of neighbour_graph()
/// \return #S by #S, symmetric, positive semi-definite, null space the constants
Eigen::SparseMatrix<double> cotangent_sample_laplacian(const Mesh& mesh, const Points& samples, double radius,
                                                       const SampleEdges& edges, const RunContext& context);

}  // namespace orbifit
