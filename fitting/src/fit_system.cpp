#include "fit_system.h"

#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "orbifit/fitting/alignment.h"
#include "orbifit/model/errors.h"

namespace orbifit {

namespace {

// Prefers the pose to a deformation that does the same, relative to one sample's share of the data.
constexpr double kPreferPose = 1e-6;

// Sum over neighbours of (R_i + R_j) / 2 (x_i - x_j) less the same unrotated: what stretching pulls towards.
Points stretch_pull(const Corotation& corotation, const std::vector<Eigen::Matrix3d>& rotations) {
  Points pull = Points::Zero(corotation.rest.rows(), 3);
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (const int j : corotation.neighbours[i]) {
      const Eigen::Vector3d edge = (corotation.rest.row(row) - corotation.rest.row(j)).transpose();
      const Eigen::Matrix3d mean = 0.5 * (rotations[i] + rotations[static_cast<std::size_t>(j)]);
      pull.row(row) += (mean * edge - edge).transpose();
    }
  }
  return pull;
}

}  // namespace

FitSystem::FitSystem(const Subspace& subspace, const Mesh& mesh, double stretch)
    : subspace_(subspace),
      mesh_(mesh),
      diagonal_(diagonal(mesh.vertices)),
      pivot_(bounding_box_centre(mesh.vertices)),
      corotation_(corotation(subspace.sampling.points, 2 * subspace.sampling.radius)),
      rotations_(static_cast<std::size_t>(subspace.sampling.points.rows()), Eigen::Matrix3d::Identity()) {
  // Per sample and neighbour, so that the stiffness means the same on every sampling.
  const double degree = std::max(1.0, corotation_.laplacian.diagonal().mean());
  corotation_.laplacian /= degree;
  corotation_.delta /= degree;
  stretch_ = stretch / degree;
  const Eigen::SparseMatrix<double> bending = corotation_.laplacian.transpose() * corotation_.laplacian;
  const Eigen::SparseMatrix<double> stretching = corotation_.laplacian * (degree * stretch_);
  stiffness_matrix_ = restricted(subspace.basis.columns, bending + stretching);
}

void FitSystem::rotate(const Eigen::VectorXd& q) {
  rotations_ = local_rotations(corotation_, corotation_.rest + sample_displacements(subspace_, q), rotations_);
}

// Sums w (row x - right)^2 row by row; a row has few entries that are not zero.
void FitSystem::Normal::add(const Eigen::RowVectorXd& row, double right, double weight, std::vector<int>& entries) {
  entries.clear();
  for (Eigen::Index j = 0; j < row.size(); ++j) {
    if (row[j] != 0) entries.push_back(static_cast<int>(j));
  }
  for (std::size_t b = 0; b < entries.size(); ++b) {
    const double scaled = weight * row[entries[b]];
    double* column = matrix.col(entries[b]).data();
    for (std::size_t a = b; a < entries.size(); ++a) column[entries[a]] += scaled * row[entries[a]];
    side[entries[b]] += scaled * right;
  }
  constant += weight * right * right;
}

FitSystem::Normal FitSystem::normal_of(const std::vector<Correspondence>& pairs, const Points& scan_points,
                                       const std::vector<Pull>& pulls, const RunContext& context) const {
  constexpr std::size_t kBlocks = 8;  // summed in turn: rounding does not depend on the number of threads
  const Eigen::Index dof = subspace_.degrees_of_freedom();
  const Normal zero{Eigen::MatrixXd::Zero(dof + 6, dof + 6), Eigen::VectorXd::Zero(dof + 6), 0};
  std::vector<Normal> blocks(kBlocks, zero);
  const double share = pairs.empty() ? 0 : static_cast<double>(rotations_.size()) / static_cast<double>(pairs.size());
  // The rest is a point of the template, which is to go to the goal, along the direction.
  const auto finish = [&](Eigen::RowVectorXd& row, const Eigen::Vector3d& goal, const Eigen::Vector3d& direction) {
    row.segment<3>(dof) = -(goal - pivot_).cross(direction).transpose() / diagonal_;
    row.tail<3>() = -direction.transpose();
  };
  parallel_for(context, kBlocks, [&](std::size_t begin, std::size_t end) {
    Eigen::RowVectorXd row(dof + 6);
    std::vector<int> entries;
    for (std::size_t b = begin; b < end; ++b) {
      for (std::size_t i = b * pairs.size() / kBlocks; i < (b + 1) * pairs.size() / kBlocks; ++i) {
        const Correspondence& pair = pairs[i];
        const Eigen::RowVector3i corners = mesh_.faces.row(pair.face);
        const Eigen::Vector3d rest = mesh_.vertices(corners, Eigen::all).transpose() * pair.barycentric;
        const Eigen::Vector3d goal = scan_points.row(pair.scan_point);
        row.setZero();
        for (int k = 0; k < 3; ++k) {
          if (pair.barycentric[k] == 0) continue;
          add_vertex_row(subspace_, corners[k], pair.barycentric[k] * pair.normal, row.head(dof));
        }
        finish(row, goal, pair.normal);
        blocks[b].add(row, pair.normal.dot(goal - rest), share * pair.weight, entries);
      }
    }
  });
  Normal total = zero;
  for (const Normal& block : blocks) {
    total.matrix += block.matrix;
    total.side += block.side;
    total.constant += block.constant;
  }
  Eigen::RowVectorXd row(dof + 6);
  std::vector<int> entries;
  for (const Pull& pull : pulls) {
    const Eigen::Vector3d rest = mesh_.vertices.row(pull.vertex);
    for (int c = 0; c < 3; ++c) {
      row.setZero();
      add_vertex_row(subspace_, pull.vertex, Eigen::Vector3d::Unit(c), row.head(dof));
      finish(row, pull.target, Eigen::Vector3d::Unit(c));
      total.add(row, pull.target[c] - rest[c], pull.weight, entries);
    }
  }
  return total;
}

FitSystem::Solution FitSystem::solve(const std::vector<Correspondence>& pairs, const Points& scan_points,
                                     const std::vector<Pull>& pulls, double stiffness, const RunContext& context) {
  const Eigen::Index dof = subspace_.degrees_of_freedom();
  const Normal data = normal_of(pairs, scan_points, pulls, context);
  Eigen::MatrixXd normal = data.matrix;
  normal.topLeftCorner(dof, dof).triangularView<Eigen::Lower>() += stiffness * stiffness_matrix_;
  normal.diagonal().head(dof).array() += kPreferPose * static_cast<double>(rotations_.size());
  normal.diagonal().tail<6>().array() += 1e-9 * static_cast<double>(rotations_.size());
  const Points pull = corotated_pull(corotation_, rotations_) + stretch_ * stretch_pull(corotation_, rotations_);
  Eigen::VectorXd side = data.side;
  side.head(dof) += stiffness * (subspace_.basis.columns.transpose() * stacked(pull));

  const Eigen::LDLT<Eigen::MatrixXd, Eigen::Lower> factor(normal);
  const Eigen::VectorXd unknowns = factor.solve(side);
  if (factor.info() != Eigen::Success || !unknowns.allFinite()) {
    throw NoResultError("the fit's linear system has no finite solution");
  }
  Solution solution;
  solution.q = unknowns.head(dof);
  solution.scan_step = small_motion(unknowns.segment<3>(dof) / diagonal_, unknowns.tail<3>(), pivot_);
  const double of_data = unknowns.dot(data.matrix.selfadjointView<Eigen::Lower>() * unknowns) -
                         2 * unknowns.dot(data.side) + data.constant;
  solution.energy = std::max(0.0, of_data) +
                    stiffness * laplace_energy(corotation_, rotations_, sample_displacements(subspace_, solution.q));
  return solution;
}

}  // namespace orbifit
