#include "deformation/handle_rows.h"

#include <algorithm>
#include <cmath>

#include "orbifit/model/errors.h"

#include "basis/subspace_parts.h"

namespace orbifit {

namespace {

constexpr std::size_t kMaxOfHandle = 48;  // of a handle

// A handle counts as the samples within r of its points, and at least as three.
double weight_of(const std::vector<int>& vertices, const Mesh& mesh, const Subspace& subspace) {
  double near = 0;
  for (Eigen::Index k = 0; k < subspace->sampling.points.rows(); ++k) {
    const double reach = subspace->sampling.radii[k] * subspace->sampling.radii[k];
    near += std::ranges::any_of(vertices, [&](int vertex) {
      return (mesh.vertices.row(vertex) - subspace->sampling.points.row(k)).squaredNorm() <= reach;
    });
  }
  return std::max(3.0, near);
}

std::vector<int> spread(const std::vector<int>& vertices) {
  if (vertices.size() <= kMaxOfHandle) return vertices;
  std::vector<int> result;
  for (std::size_t k = 0; k < kMaxOfHandle; ++k) result.push_back(vertices[k * vertices.size() / kMaxOfHandle]);
  return result;
}

}  // namespace

HandleRows::HandleRows(const std::vector<Handle>& handles, const Subspace& subspace, const Mesh& mesh) {
  const Eigen::Index freedom = subspace.degrees_of_freedom();
  for (const Handle& handle : handles) {
    if (handle.vertices.empty()) throw UsageError("handle \"" + handle.name + "\" takes no vertex");
    const std::vector<int> points = spread(handle.vertices);
    Part part;
    part.first = vertices_.size();
    part.count = points.size();
    part.weight = weight_of(points, mesh, subspace) / static_cast<double>(points.size());
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows =
        Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(points.size()), freedom);
    for (std::size_t i = 0; i < points.size(); ++i) {
      Eigen::Matrix3Xd own = Eigen::Matrix3Xd::Zero(3, freedom);
      add_vertex_rows(subspace, subspace->basis, points[i], own);
      rows.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = own;
      vertices_.push_back(points[i]);
      weights_.push_back(part.weight);
      total_ += part.weight;
    }
    for (Eigen::Index j = 0; j < freedom; ++j) {
      if (!rows.col(j).isZero(0)) part.columns.push_back(j);
    }
    part.rows = rows(Eigen::all, part.columns);
    parts_.push_back(std::move(part));
  }
  rest_ = mesh.vertices(vertices_, Eigen::all);
}

Eigen::SparseMatrix<double> HandleRows::gram(Eigen::Index freedom) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Part& part : parts_) {
    const auto size = static_cast<Eigen::Index>(part.columns.size());
    if (size == 0) continue;  // nothing moves it, and a product of no rows refers to the first of them
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(size, size);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(part.rows.transpose(), part.weight);
    for (Eigen::Index j = 0; j < size; ++j) {
      for (Eigen::Index i = j; i < size; ++i) {
        if (gram(i, j) == 0) continue;  // x, y and z do not mix everywhere
        entries.emplace_back(part.columns[static_cast<std::size_t>(i)], part.columns[static_cast<std::size_t>(j)],
                             gram(i, j));
      }
    }
  }
  Eigen::SparseMatrix<double> result(freedom, freedom);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Eigen::VectorXd HandleRows::targets(const std::vector<Motion>& motions) const {
  Eigen::VectorXd result(3 * rest_.rows());
  for (std::size_t h = 0; h < parts_.size(); ++h) {
    for (std::size_t i = parts_[h].first; i < parts_[h].first + parts_[h].count; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const Eigen::Vector3d rest = rest_.row(row);
      result.segment<3>(3 * row) = motions[h](rest) - rest;
    }
  }
  return result;
}

Eigen::VectorXd HandleRows::pull(const Eigen::VectorXd& targets, Eigen::Index freedom) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(freedom);
  for (const Part& part : parts_) {
    const auto wanted = targets.segment(3 * static_cast<Eigen::Index>(part.first), part.rows.rows());
    const Eigen::VectorXd local = part.weight * (part.rows.transpose() * wanted);
    for (std::size_t j = 0; j < part.columns.size(); ++j) {
      result[part.columns[j]] += local[static_cast<Eigen::Index>(j)];
    }
  }
  return result;
}

double HandleRows::squared_error(const Eigen::VectorXd& q, const Eigen::VectorXd& targets) const {
  double result = 0;
  for (const Part& part : parts_) {
    const Eigen::VectorXd local = q(part.columns);
    const auto wanted = targets.segment(3 * static_cast<Eigen::Index>(part.first), part.rows.rows());
    result += part.weight * (part.rows * local - wanted).squaredNorm();
  }
  return result;
}

}  // namespace orbifit
