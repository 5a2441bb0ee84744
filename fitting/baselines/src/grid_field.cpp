#include "grid_field.h"

#include <algorithm>
#include <array>

namespace orbifit {

namespace {

// The functions that do not vanish on a cell, at t in [0, 1] along it.
std::array<double, 4> values_along(GridBasis basis, double t) {
  if (basis == GridBasis::linear) return {1 - t, t, 0, 0};
  const double s = 1 - t;
  return {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6};
}

}  // namespace

Eigen::Array3i place_of(int number, const Eigen::Array3i& counts) {
  return {number / (counts[1] * counts[2]), number / counts[2] % counts[1], number % counts[2]};
}

Grid grid_around(const Points& points, double spacing, GridBasis basis) {
  const Eigen::Array3d low = points.colwise().minCoeff().transpose();
  const Eigen::Array3d high = points.colwise().maxCoeff().transpose();
  Grid grid;
  grid.spacing = spacing;
  grid.basis = basis;
  // A hair less, so that rounding does not add a layer of cells.
  grid.cells = ((high - low) / spacing + 1 - 1e-9).ceil().cast<int>();
  grid.corner = (0.5 * (low + high) - 0.5 * spacing * grid.cells.cast<double>()).matrix();
  return grid;
}

SparseRows basis_values(const Grid& grid, const Points& points) {
  const int width = grid.basis == GridBasis::linear ? 2 : 4;
  const Eigen::Array3i nodes = grid.nodes();
  SparseRows rows(points.rows(), nodes.prod());
  if (points.rows() == 0) return rows;  // Eigen 3.4 reads beyond the end of what it compresses there
  rows.reserve(Eigen::VectorXi::Constant(points.rows(), width * width * width));
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    Eigen::Array3i cell;
    std::array<std::array<double, 4>, 3> along;
    for (int a = 0; a < 3; ++a) {
      const double at = (points(p, a) - grid.corner[a]) / grid.spacing;
      cell[a] = static_cast<int>(std::clamp(std::floor(at), 0.0, grid.cells[a] - 1.0));
      along[static_cast<std::size_t>(a)] = values_along(grid.basis, at - cell[a]);
    }
    for (int i = 0; i < width; ++i) {
      for (int j = 0; j < width; ++j) {
        for (int k = 0; k < width; ++k) {
          const int node = ((cell[0] + i) * nodes[1] + cell[1] + j) * nodes[2] + cell[2] + k;
          rows.insert(p, node) = along[0][static_cast<std::size_t>(i)] * along[1][static_cast<std::size_t>(j)] *
                                 along[2][static_cast<std::size_t>(k)];
        }
      }
    }
  }
  rows.makeCompressed();
  return rows;
}

Points affine_coefficients(const Grid& grid, const Eigen::Matrix3d& linear, const Eigen::Vector3d& translation) {
  const Eigen::Array3i nodes = grid.nodes();
  // Cubic B-splines reproduce x from the places of their nodes, which begin one spacing before the cells.
  const double first = grid.basis == GridBasis::linear ? 0 : -1;
  Points result(nodes.prod(), 3);
  for (Eigen::Index n = 0; n < result.rows(); ++n) {
    const Eigen::Array3d at = place_of(static_cast<int>(n), nodes).cast<double>();
    const Eigen::Vector3d place = grid.corner + (grid.spacing * (at + first)).matrix();
    result.row(n) = (linear * place + translation).transpose();
  }
  return result;
}

}  // namespace orbifit
