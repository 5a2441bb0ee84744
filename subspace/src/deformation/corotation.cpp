#include "deformation/corotation.h"

#include <algorithm>
#include <utility>

#include <Eigen/LU>

#include "base/dense.h"
#include "kernels/kernels.h"

namespace orbifit {

namespace {

// Weight of the previous rotation against the neighbourhood's covariance: decides only what that leaves open.
constexpr double kAnchor = 1e-6;

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& covariance) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

// The rotations nearest to the covariances, numbered by `held`, from those before; four at a time, the last few filled
// up with repetitions.
void turn_to(const std::vector<Eigen::Matrix3d>& covariances, const std::vector<std::size_t>& held,
             std::vector<Eigen::Matrix3d>& rotations) {
  constexpr std::size_t kAtATime = 4;
  double matrices[9 * kAtATime];
  double found[9 * kAtATime];
  for (std::size_t begin = 0; begin < held.size(); begin += kAtATime) {
    for (std::size_t lane = 0; lane < kAtATime; ++lane) {
      const std::size_t k = std::min(begin + lane, held.size() - 1);
      for (std::size_t e = 0; e < 9; ++e) {
        matrices[kAtATime * e + lane] = covariances[k].data()[e];
        found[kAtATime * e + lane] = rotations[held[k]].data()[e];
      }
    }
    const unsigned missed = kernels().nearest_rotations(matrices, found);
    for (std::size_t lane = 0; lane < kAtATime && begin + lane < held.size(); ++lane) {
      Eigen::Matrix3d& rotation = rotations[held[begin + lane]];
      if ((missed >> lane & 1U) != 0) {
        rotation = nearest_rotation(covariances[begin + lane]);
        continue;
      }
      for (std::size_t e = 0; e < 9; ++e) rotation.data()[e] = found[kAtATime * e + lane];
    }
  }
}

}  // namespace

Corotation corotation(const Points& samples, double distance) {
  const SampleEdges edges = neighbour_graph(samples, distance);
  return corotation(samples, edges, graph_laplacian(edges, samples.rows()));
}

Corotation corotation(const Points& samples, const SampleEdges& edges, const Eigen::SparseMatrix<double>& laplacian) {
  Corotation result;
  result.rest = samples;
  result.neighbours.resize(static_cast<std::size_t>(samples.rows()));
  for (const auto& [i, j] : edges) {
    result.neighbours[static_cast<std::size_t>(i)].push_back(j);
    result.neighbours[static_cast<std::size_t>(j)].push_back(i);
  }
  result.laplacian = laplacian;
  result.delta = result.laplacian * samples;
  return result;
}

std::vector<Eigen::Matrix3d> local_rotations(const Corotation& corotation, const Points& deformed,
                                             const std::vector<Eigen::Matrix3d>& previous) {
  std::vector<Eigen::Matrix3d> rotations = previous;
  std::vector<Eigen::Matrix3d> covariances(previous.size(), Eigen::Matrix3d::Zero());
  std::vector<double> sizes(previous.size(), 0);
  for (std::size_t i = 0; i < previous.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (const int j : corotation.neighbours[i]) {
      const Eigen::RowVector3d rest = corotation.rest.row(j) - corotation.rest.row(row);
      const Eigen::RowVector3d now = deformed.row(j) - deformed.row(row);
      covariances[i] += now.transpose() * rest;
      sizes[i] += rest.squaredNorm();
    }
  }
  turn_locally(std::move(covariances), sizes, rotations);
  return rotations;
}

void turn_locally(std::vector<Eigen::Matrix3d> covariances, const std::vector<double>& sizes,
                  std::vector<Eigen::Matrix3d>& rotations) {
  std::vector<std::size_t> held;  // samples that have neighbours
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    if (!(sizes[i] > 0)) continue;
    covariances[held.size()] = covariances[i] + kAnchor * sizes[i] * rotations[i];
    held.push_back(i);
  }
  turn_to(covariances, held, rotations);
}

Points corotated_pull(const Corotation& corotation, const std::vector<Eigen::Matrix3d>& rotations) {
  Points turned(corotation.delta.rows(), 3);
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    turned.row(row) = (rotations[i] * corotation.delta.row(row).transpose()).transpose() - corotation.delta.row(row);
  }
  return corotation.laplacian.transpose() * turned;
}

double laplace_energy(const Corotation& corotation, const std::vector<Eigen::Matrix3d>& rotations,
                      const Points& displacements) {
  Points difference = corotation.laplacian * displacements + corotation.delta;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    difference.row(row) -= (rotations[i] * corotation.delta.row(row).transpose()).transpose();
  }
  return difference.squaredNorm();
}

Eigen::SparseMatrix<double> restricted(const Eigen::SparseMatrix<double>& columns,
                                       const Eigen::SparseMatrix<double>& scalar) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(3 * static_cast<std::size_t>(scalar.nonZeros()));
  for (Eigen::Index k = 0; k < scalar.outerSize(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(scalar, k); entry; ++entry) {
      for (int c = 0; c < 3; ++c) entries.emplace_back(3 * entry.row() + c, 3 * entry.col() + c, entry.value());
    }
  }
  Eigen::SparseMatrix<double> block(3 * scalar.rows(), 3 * scalar.cols());
  block.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> half = block * columns;
  const Eigen::SparseMatrix<double> full = columns.transpose() * half;
  const Eigen::SparseMatrix<double> other = full.transpose();
  return 0.5 * (full + other);
}

Eigen::VectorXd stacked(const Points& rows) {
  return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
}

}  // namespace orbifit
