#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// One basis function a node, by coordinates: b(x) = prod_a b((x_a - node_a) / spacing).
enum class GridBasis {
  linear,  ///< hats: trilinear in each cell, 8 functions at a point
  cubic    ///< uniform cubic B-splines, 64 functions at a point
};

/// A regular grid of basis functions around a shape (Kurz et al. 2014, section 4). Node (i, j, k) has the number
/// (i * nodes_y + j) * nodes_z + k.
struct Grid {
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();  ///< of the cells
  double spacing = 0;                                ///< of the nodes along all axes, > 0
  Eigen::Array3i cells = Eigen::Array3i::Ones();
  GridBasis basis = GridBasis::linear;

  Eigen::Array3i nodes() const { return cells + (basis == GridBasis::linear ? 1 : 3); }
  int node_count() const { return nodes().prod(); }
};

/// Where number k stands among counts in x by y by z, z first.
Eigen::Array3i place_of(int number, const Eigen::Array3i& counts);

/// The grid whose cells, with half a spacing to spare, hold the points, and whose centre is that of their box.
Grid grid_around(const Points& points, double spacing, GridBasis basis);

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// The functions' values at points, #P by nodes; rows sum to 1. Outside of the cells the nearest cell's polynomials
/// go on.
SparseRows basis_values(const Grid& grid, const Points& points);

/// The coefficients, #nodes by 3, for which the functions add up to linear * x + translation.
Points affine_coefficients(const Grid& grid, const Eigen::Matrix3d& linear, const Eigen::Vector3d& translation);

}  // namespace orbifit
