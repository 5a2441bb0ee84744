#include "fit_system.h"

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

void FitSystem::add_surface_row(const std::vector<std::pair<int, double>>& vertices, const Eigen::Vector3d& direction,
                                Eigen::Ref<Eigen::RowVectorXd> row) {
  for (const auto& [vertex, share] : vertices) {
    if (share != 0) add_vertex_row(subspace_, vertex, share * direction, row);
  }
}

FitSystem::Solution FitSystem::solve(const std::vector<Correspondence>& pairs, const Points& scan_points,
                                     const std::vector<Pull>& pulls, double stiffness) {
  const Eigen::Index dof = subspace_.degrees_of_freedom();
  const auto data_rows = static_cast<Eigen::Index>(pairs.size());
  const Eigen::Index rows = data_rows + 3 * static_cast<Eigen::Index>(pulls.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> system = Eigen::MatrixXd::Zero(rows, dof + 6);
  Eigen::VectorXd right(rows);
  Eigen::VectorXd weights(rows);
  const auto add_row = [&](Eigen::Index row, const std::vector<std::pair<int, double>>& vertices,
                           const Eigen::Vector3d& rest, const Eigen::Vector3d& goal, const Eigen::Vector3d& direction,
                           double weight) {
    add_surface_row(vertices, direction, system.row(row).head(dof));
    system.row(row).segment<3>(dof) = -(goal - pivot_).cross(direction).transpose() / diagonal_;
    system.row(row).tail<3>() = -direction.transpose();
    right[row] = direction.dot(goal - rest);
    weights[row] = weight;
  };

  const double share = pairs.empty() ? 0 : static_cast<double>(rotations_.size()) / static_cast<double>(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Correspondence& pair = pairs[i];
    const Eigen::RowVector3i corners = mesh_.faces.row(pair.face);
    const Eigen::Vector3d rest = mesh_.vertices(corners, Eigen::all).transpose() * pair.barycentric;
    add_row(static_cast<Eigen::Index>(i),
            {{corners[0], pair.barycentric[0]}, {corners[1], pair.barycentric[1]}, {corners[2], pair.barycentric[2]}},
            rest, scan_points.row(pair.scan_point).transpose(), pair.normal, share * pair.weight);
  }
  Eigen::Index row = data_rows;
  for (const Pull& pull : pulls) {
    for (int c = 0; c < 3; ++c) {
      add_row(row++, {{pull.vertex, 1.0}}, mesh_.vertices.row(pull.vertex).transpose(), pull.target,
              Eigen::Vector3d::Unit(c), pull.weight);
    }
  }

  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(dof + 6, dof + 6);
  const Eigen::MatrixXd weighted = weights.cwiseSqrt().asDiagonal() * system;
  normal.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
  normal.topLeftCorner(dof, dof).triangularView<Eigen::Lower>() += stiffness * stiffness_matrix_;
  normal.diagonal().head(dof).array() += kPreferPose * static_cast<double>(rotations_.size());
  normal.diagonal().tail<6>().array() += 1e-9 * static_cast<double>(rotations_.size());
  const Points pull = corotated_pull(corotation_, rotations_) + stretch_ * stretch_pull(corotation_, rotations_);
  Eigen::VectorXd side = system.transpose() * weights.cwiseProduct(right);
  side.head(dof) += stiffness * (subspace_.basis.columns.transpose() * stacked(pull));

  const Eigen::LDLT<Eigen::MatrixXd, Eigen::Lower> factor(normal);
  const Eigen::VectorXd unknowns = factor.solve(side);
  if (factor.info() != Eigen::Success || !unknowns.allFinite()) {
    throw NoResultError("the fit's linear system has no finite solution");
  }
  Solution solution;
  solution.q = unknowns.head(dof);
  solution.scan_step = small_motion(unknowns.segment<3>(dof) / diagonal_, unknowns.tail<3>(), pivot_);
  const Eigen::VectorXd residuals = system * unknowns - right;
  solution.energy = weights.dot(residuals.cwiseAbs2()) +
                    stiffness * laplace_energy(corotation_, rotations_, sample_displacements(subspace_, solution.q));
  return solution;
}

}  // namespace orbifit
