#include "kurz_normal.h"

#include <string>
#include <vector>

#include "orbifit/model/errors.h"

#include "base/dense.h"

namespace orbifit {

namespace {

using Sparse = Eigen::SparseMatrix<double>;

Sparse weighted_product(const SparseRows& left, const Eigen::VectorXd& weights, const SparseRows& right) {
  return Sparse(left.transpose() * weights.asDiagonal() * right);
}

// The functions that meet in a cell, as data may link them.
Sparse cell_pattern(const Grid& grid) {
  Points centres(grid.cells.prod(), 3);
  for (Eigen::Index c = 0; c < centres.rows(); ++c) {
    const Eigen::Array3d at = place_of(static_cast<int>(c), grid.cells).cast<double>();
    centres.row(c) = (grid.corner.array() + grid.spacing * (at + 0.5)).matrix().transpose();
  }
  const SparseRows values = basis_values(grid, centres);
  return Sparse(values.transpose() * values);
}

Sparse with_carriers(const Sparse& nodes, const KurzTerms& terms) {
  const auto count = static_cast<int>(nodes.cols());
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < count; ++j) {
    for (Sparse::InnerIterator each(nodes, j); each; ++each) {
      entries.emplace_back(static_cast<int>(each.row()), j, 1.0);
    }
  }
  for (std::size_t d = 0; d < terms.symmetry.demands.size(); ++d) {
    for (const auto& [carrier, matrix] : terms.symmetry.demands[d].shift) {
      for (const SparseRows* values : {&terms.at_points[d], &terms.at_images[d]}) {
        for (int i = 0; i < values->outerSize(); ++i) {
          for (SparseRows::InnerIterator each(*values, i); each; ++each) {
            entries.emplace_back(count + carrier, static_cast<int>(each.col()), 1.0);
          }
        }
      }
      for (const auto& [other, unused] : terms.symmetry.demands[d].shift) {
        entries.emplace_back(count + carrier, count + other, 1.0);
      }
    }
  }
  Sparse result(count + terms.symmetry.carriers, count + terms.symmetry.carriers);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Sparse pattern_of(const KurzTerms& terms, const Sparse& plate, const std::vector<Sparse>& mixed) {
  Sparse nodes = cell_pattern(terms.grid) + plate;
  for (const Sparse& each : mixed) nodes += each + Sparse(each.transpose());
  return with_carriers(nodes, terms);
}

std::vector<Sparse> mixed_products(const KurzTerms& terms) {
  std::vector<Sparse> result;
  for (std::size_t d = 0; d < terms.symmetry.demands.size(); ++d) {
    result.emplace_back(terms.symmetry.demands[d].weight * Sparse(terms.at_images[d].transpose() * terms.at_points[d]));
  }
  return result;
}

}  // namespace

KurzNormal::KurzNormal(const KurzTerms& terms, const Sparse& plate)
    : terms_(terms),
      plate_(plate),
      diagonal_(plate.rows(), plate.cols()),
      mixed_(mixed_products(terms)),
      matrix_(pattern_of(terms, plate, mixed_)) {
  for (std::size_t d = 0; d < mixed_.size(); ++d) {
    const double weight = terms.symmetry.demands[d].weight;
    const SparseRows& points = terms.at_points[d];
    const SparseRows& images = terms.at_images[d];
    const Eigen::VectorXd ones = Eigen::VectorXd::Constant(points.rows(), weight);
    diagonal_ += weighted_product(points, ones, points) + weighted_product(images, ones, images);
    sums_.emplace_back(points.transpose() * ones);
    image_sums_.emplace_back(images.transpose() * ones);
  }
  const PullTerm& pulls = terms.pulls;
  if (pulls.weights.size() > 0) pulls_ = weighted_product(pulls.values, pulls.weights, pulls.values);
}

void KurzNormal::add_constant() {
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  matrix_.add_product(plate_, terms_.thin_plate * one, false);
  matrix_.add_product(diagonal_, terms_.symmetry_weight * one, false);
  if (pulls_.size() > 0) matrix_.add_product(pulls_, one, false);
  for (int i = 0; i < static_cast<int>(plate_.cols()) + terms_.symmetry.carriers; ++i) {
    matrix_.add(i, i, terms_.hold * one);
  }
}

// |M u(x) + sum C t + ... - u(g x)|^2 but for what stands in diagonal_.
void KurzNormal::add_symmetry(const KurzState& state) {
  for (std::size_t d = 0; d < mixed_.size(); ++d) {
    const SymmetryDemand& demand = terms_.symmetry.demands[d];
    const Eigen::Matrix3d linear = carried_linear(demand, state.rotations);
    matrix_.add_product(mixed_[d], -terms_.symmetry_weight * linear, true);
    add_carriers(demand, linear, d);
  }
  hold_open_carriers();
}

void KurzNormal::add_carriers(const SymmetryDemand& demand, const Eigen::Matrix3d& linear, std::size_t number) {
  const auto nodes = static_cast<int>(plate_.cols());
  const double weight = terms_.symmetry_weight;
  const double total = weight * demand.weight * static_cast<double>(demand.points.rows());
  const Carried shift = carried_shift(demand, linear);
  for (const auto& [carrier, matrix] : shift) {
    for (const auto& [other, factor] : shift) {
      if (other <= carrier) matrix_.add(nodes + carrier, nodes + other, total * matrix.transpose() * factor);
    }
    const Eigen::Matrix3d from = weight * matrix.transpose() * linear;
    const Eigen::Matrix3d to = -weight * matrix.transpose();
    for (int i = 0; i < nodes; ++i) {
      const double at_point = sums_[number][i];
      const double at_image = image_sums_[number][i];
      if (at_point == 0 && at_image == 0) continue;
      matrix_.add(nodes + carrier, i, at_point * from + at_image * to);
    }
  }
}

// A shift along an axis or within a plane carries nothing: it is kept at zero, as stiffly as the rest.
void KurzNormal::hold_open_carriers() {
  constexpr double kOpen = 1e-9;
  const auto nodes = static_cast<int>(plate_.cols());
  for (int carrier = 0; carrier < terms_.symmetry.carriers; ++carrier) {
    Eigen::Matrix3d own = matrix_.block(nodes + carrier, nodes + carrier);
    own.diagonal().array() -= terms_.hold;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(own);
    const double largest = eigen.eigenvalues()[2];
    for (int k = 0; k < 3; ++k) {
      if (eigen.eigenvalues()[k] > kOpen * largest) continue;
      const Eigen::Vector3d direction = eigen.eigenvectors().col(k);
      matrix_.add(nodes + carrier, nodes + carrier, largest * direction * direction.transpose());
    }
  }
}

void KurzNormal::add_data(const DataTerm& data) {
  for (int i = 0; i < data.values.outerSize(); ++i) {
    const Eigen::Vector3d normal = data.normals.row(i);
    const Eigen::Matrix3d block = data.weights[i] * normal * normal.transpose();
    for (SparseRows::InnerIterator a(data.values, i); a; ++a) {
      for (SparseRows::InnerIterator b(data.values, i); b && b.col() <= a.col(); ++b) {
        matrix_.add(static_cast<int>(a.col()), static_cast<int>(b.col()), a.value() * b.value() * block);
      }
    }
  }
}

Eigen::VectorXd KurzNormal::right_side(const DataTerm& data, const KurzState& state) const {
  Points nodes = terms_.hold * state.nodes;
  Points carriers = terms_.hold * state.carriers;
  const PullTerm& pulls = terms_.pulls;
  if (pulls.weights.size() > 0) nodes += pulls.values.transpose() * (pulls.weights.asDiagonal() * pulls.offsets);
  if (data.weights.size() > 0) {
    const Eigen::VectorXd offsets = data.offsets.cwiseProduct(data.normals).rowwise().sum();
    const Eigen::VectorXd weighted = offsets.cwiseProduct(data.weights);
    nodes += data.values.transpose() * (weighted.asDiagonal() * data.normals);
  }
  const Points none = Points::Zero(carriers.rows(), 3);
  for (std::size_t d = 0; d < mixed_.size(); ++d) {
    const SymmetryDemand& demand = terms_.symmetry.demands[d];
    const Eigen::Matrix3d linear = carried_linear(demand, state.rotations);
    const Points rest = terms_.symmetry_weight * demand.weight *
                        symmetry_differences(demand, state.rotations, none, demand.points, demand.images);
    nodes += terms_.at_images[d].transpose() * rest - terms_.at_points[d].transpose() * (rest * linear);
    for (const auto& [carrier, matrix] : carried_shift(demand, linear)) {
      carriers.row(carrier) -= rest.colwise().sum() * matrix;
    }
  }
  Eigen::VectorXd result(nodes.size() + carriers.size());
  result << nodes.reshaped<Eigen::RowMajor>(), carriers.reshaped<Eigen::RowMajor>();
  return result;
}

void KurzNormal::solve(const DataTerm& data, KurzState& state) {
  if (constant_.empty() || thin_plate_ != terms_.thin_plate || rotations_ != state.rotations) {
    matrix_.set_zero();
    add_constant();
    add_symmetry(state);
    constant_ = matrix_.blocks();
    thin_plate_ = terms_.thin_plate;
    rotations_ = state.rotations;
  } else {
    matrix_.set_blocks(constant_);
  }
  add_data(data);
  if (!matrix_.factorise()) {
    throw NoResultError("the normal matrix is not positive definite: its condition exceeds what rounding leaves");
  }
  const Eigen::VectorXd unknowns = matrix_.solve(right_side(data, state));
  if (!unknowns.allFinite()) throw NoResultError("the linear system has no finite solution");
  const Eigen::Index nodes = state.nodes.rows();
  state.nodes = unknowns.head(3 * nodes).reshaped<Eigen::RowMajor>(nodes, 3);
  state.carriers = unknowns.tail(3 * state.carriers.rows()).reshaped<Eigen::RowMajor>(state.carriers.rows(), 3);
}

}  // namespace orbifit
