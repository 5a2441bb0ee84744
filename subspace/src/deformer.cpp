#include "orbifit/subspace/deformer.h"

#include <algorithm>
#include <cmath>

#include "orbifit/model/errors.h"
#include "orbifit/model/point_index.h"

namespace orbifit {

namespace {

// Keeps what neither Laplacian nor handles hold where it is: relative to the mean of the diagonal.
constexpr double kHold = 1e-12;

// A handle counts as the samples within r of its vertices, and at least as three.
double weight_of(const Handle& handle, const Mesh& mesh, const PointIndex& samples, double radius) {
  std::vector<int> near;
  for (const int vertex : handle.vertices) {
    for (const auto& neighbour : samples.within(mesh.vertices.row(vertex).transpose(), radius)) {
      near.push_back(neighbour.index);
    }
  }
  std::ranges::sort(near);
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return std::max(3.0, static_cast<double>(near.size()));
}

}  // namespace

Deformer::Deformer(const Subspace& subspace, const Mesh& mesh)
    : subspace_(subspace),
      mesh_(mesh),
      corotation_(corotation(subspace.sampling.points, 2 * subspace.sampling.radius)),
      stiffness_(restricted(subspace.basis.columns,
                            Eigen::SparseMatrix<double>(corotation_.laplacian.transpose() * corotation_.laplacian))) {}

void Deformer::set_handles(const std::vector<Handle>& handles, double alpha) {
  handles_ = handles;
  alpha_ = alpha;
  std::vector<int> rows;
  std::vector<double> weights;
  const PointIndex samples(subspace_.sampling.points);
  for (const Handle& handle : handles) {
    if (handle.vertices.empty()) throw UsageError("handle \"" + handle.name + "\" takes no vertex");
    const double each =
        weight_of(handle, mesh_, samples, subspace_.sampling.radius) / static_cast<double>(handle.vertices.size());
    for (const int vertex : handle.vertices) {
      rows.push_back(vertex);
      weights.push_back(each);
    }
  }
  handle_weights_ = Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  handle_lift_.resize(static_cast<Eigen::Index>(rows.size()), subspace_.sampling.points.rows());
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (LiftWeights::InnerIterator entry(subspace_.lift, rows[i]); entry; ++entry) {
      entries.emplace_back(static_cast<Eigen::Index>(i), entry.col(), entry.value());
    }
  }
  handle_lift_.setFromTriplets(entries.begin(), entries.end());

  // Equation (4), left; A = lift (x) I_3, so its Gram matrix is scalar too.
  const Eigen::SparseMatrix<double> weighted = handle_weights_.asDiagonal() * handle_lift_;
  const Eigen::SparseMatrix<double> gram = handle_lift_.transpose() * weighted;
  Eigen::MatrixXd system = stiffness_ + alpha * restricted(subspace_.basis.columns, gram);
  system.diagonal().array() += kHold * system.diagonal().mean();
  factor_.compute(system);
  if (factor_.info() != Eigen::Success) throw NoResultError("the handles' system could not be factorised");
}

Points Deformer::handle_targets(const std::vector<Motion>& motions) const {
  Points targets(handle_weights_.size(), 3);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < handles_.size(); ++i) {
    for (const int vertex : handles_[i].vertices) {
      const Eigen::Vector3d rest = mesh_.vertices.row(vertex);
      targets.row(row++) = motions[i](rest) - rest;
    }
  }
  return targets;
}

Deformation Deformer::solve(const std::vector<Motion>& motions, int iterations, const Eigen::VectorXd& start) const {
  if (motions.size() != handles_.size()) {
    throw UsageError("there are " + std::to_string(handles_.size()) + " handles but " + std::to_string(motions.size()) +
                     " motions");
  }
  const Eigen::SparseMatrix<double>& columns = subspace_.basis.columns;
  const Points targets = handle_targets(motions);
  const Points handle_pull = alpha_ * (handle_lift_.transpose() * (handle_weights_.asDiagonal() * targets));

  Deformation result;
  result.q = start.size() == columns.cols() ? start : Eigen::VectorXd::Zero(columns.cols());
  Points displacements = sample_displacements(subspace_, result.q);
  std::vector<Eigen::Matrix3d> rotations(corotation_.neighbours.size(), Eigen::Matrix3d::Identity());
  if (start.size() == columns.cols()) {
    rotations = local_rotations(corotation_, corotation_.rest + displacements, rotations);
  }
  for (int iteration = 0; iteration < iterations; ++iteration) {
    // Equation (4), right, with the Laplace coordinates turned.
    const Points pull = corotated_pull(corotation_, rotations) + handle_pull;
    result.q = factor_.solve(columns.transpose() * stacked(pull));
    const Points next = sample_displacements(subspace_, result.q);
    result.last_change = next.rows() > 0 ? (next - displacements).rowwise().norm().maxCoeff() : 0;
    displacements = next;
    rotations = local_rotations(corotation_, corotation_.rest + displacements, rotations);
  }
  const Points missed = handle_lift_ * displacements - targets;
  const double squares = missed.rowwise().squaredNorm().dot(handle_weights_);
  result.handle_error = std::sqrt(squares / handle_weights_.sum());
  result.energy = laplace_energy(corotation_, rotations, displacements) + alpha_ * squares;
  return result;
}

}  // namespace orbifit
