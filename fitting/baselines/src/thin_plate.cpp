#include "thin_plate.h"

#include <array>
#include <cmath>
#include <vector>

#include <unsupported/Eigen/KroneckerProduct>

namespace orbifit {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

// Along one axis: rows whose squares add up to the integral of the square of the function, of its first and of its
// second derivative.
using AxisRows = std::array<Sparse, 3>;

AxisRows difference_rows(int nodes, double spacing) {
  const double root = std::sqrt(spacing);
  Triplets value;
  Triplets first;
  Triplets second;
  for (int i = 0; i < nodes; ++i) {
    const bool end = i == 0 || i == nodes - 1;
    value.emplace_back(i, i, end ? root * std::sqrt(0.5) : root);
    if (i + 1 < nodes) {
      first.emplace_back(i, i, -root / spacing);
      first.emplace_back(i, i + 1, root / spacing);
    }
    if (end) continue;
    const double scale = root / (spacing * spacing);
    second.emplace_back(i - 1, i - 1, scale);
    second.emplace_back(i - 1, i, -2 * scale);
    second.emplace_back(i - 1, i + 1, scale);
  }
  AxisRows rows{Sparse(nodes, nodes), Sparse(nodes - 1, nodes), Sparse(std::max(nodes - 2, 0), nodes)};
  rows[0].setFromTriplets(value.begin(), value.end());
  rows[1].setFromTriplets(first.begin(), first.end());
  rows[2].setFromTriplets(second.begin(), second.end());
  return rows;
}

// Four points of Gauss and Legendre a cell integrate the products of cubics, of degree 6, exactly.
AxisRows spline_rows(int cells, double spacing) {
  constexpr std::array<double, 4> kPlaces{0.0694318442029737124, 0.330009478207571868, 0.669990521792428132,
                                          0.930568155797026288};
  constexpr std::array<double, 4> kWeights{0.173927422568726929, 0.326072577431273071, 0.326072577431273071,
                                           0.173927422568726929};
  std::array<Triplets, 3> entries;
  for (int cell = 0; cell < cells; ++cell) {
    for (int g = 0; g < 4; ++g) {
      const double t = kPlaces[static_cast<std::size_t>(g)];
      const double s = 1 - t;
      const double root = std::sqrt(spacing * kWeights[static_cast<std::size_t>(g)]);
      const std::array<std::array<double, 4>, 3> values{
          {{s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6},
           {-s * s / 2, (3 * t - 4) * t / 2, (4 - 3 * s) * s / 2, t * t / 2},
           {s, 3 * t - 2, 3 * s - 2, t}}};
      for (std::size_t d = 0; d < 3; ++d) {
        const double scale = root / std::pow(spacing, double(d));
        for (int k = 0; k < 4; ++k) {
          entries[d].emplace_back(4 * cell + g, cell + k, scale * values[d][static_cast<std::size_t>(k)]);
        }
      }
    }
  }
  AxisRows rows;
  for (std::size_t d = 0; d < 3; ++d) {
    rows[d].resize(4 * cells, cells + 3);
    rows[d].setFromTriplets(entries[d].begin(), entries[d].end());
  }
  return rows;
}

struct Axes {
  std::array<AxisRows, 3> rows;

  explicit Axes(const Grid& grid) {
    for (int a = 0; a < 3; ++a) {
      rows[static_cast<std::size_t>(a)] = grid.basis == GridBasis::linear
                                              ? difference_rows(grid.nodes()[a], grid.spacing)
                                              : spline_rows(grid.cells[a], grid.spacing);
    }
  }
};

// The order of the derivative along each axis, and how often it stands in the Hessian.
struct Entry {
  std::array<std::size_t, 3> order;
  double times;
};
constexpr std::array<Entry, 6> kHessian{
    {{{2, 0, 0}, 1}, {{0, 2, 0}, 1}, {{0, 0, 2}, 1}, {{1, 1, 0}, 2}, {{1, 0, 1}, 2}, {{0, 1, 1}, 2}}};

Sparse product(const Sparse& x, const Sparse& y, const Sparse& z) {
  return Eigen::kroneckerProduct(x, Sparse(Eigen::kroneckerProduct(y, z)));
}

}  // namespace

Eigen::SparseMatrix<double> thin_plate(const Grid& grid) {
  Axes axes(grid);
  for (AxisRows& along : axes.rows) {
    for (Sparse& rows : along) rows = Sparse(rows.transpose() * rows);
  }
  Sparse result(grid.node_count(), grid.node_count());
  for (const Entry& entry : kHessian) {
    const auto& [x, y, z] = entry.order;
    result += entry.times * product(axes.rows[0][x], axes.rows[1][y], axes.rows[2][z]);
  }
  return result;
}

SparseRows thin_plate_rows(const Grid& grid) {
  const Axes axes(grid);
  Triplets entries;
  Eigen::Index count = 0;
  for (const Entry& entry : kHessian) {
    const auto& [x, y, z] = entry.order;
    const Sparse rows = product(axes.rows[0][x], axes.rows[1][y], axes.rows[2][z]);
    for (int j = 0; j < rows.outerSize(); ++j) {
      for (Sparse::InnerIterator each(rows, j); each; ++each) {
        entries.emplace_back(static_cast<int>(count + each.row()), j, std::sqrt(entry.times) * each.value());
      }
    }
    count += rows.rows();
  }
  SparseRows result(count, grid.node_count());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace orbifit
