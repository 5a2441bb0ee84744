#include "kurz_terms.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "base/dense.h"

namespace orbifit {

KurzTerms kurz_terms(const Grid& grid, const SymmetryDemands& symmetry) {
  KurzTerms terms;
  terms.grid = grid;
  terms.symmetry = symmetry;
  for (const SymmetryDemand& demand : symmetry.demands) {
    terms.at_points.push_back(basis_values(grid, demand.points));
    terms.at_images.push_back(basis_values(grid, demand.images));
  }
  return terms;
}

KurzState rest_state(const KurzTerms& terms, std::size_t regions) {
  return {Points::Zero(terms.grid.node_count(), 3), Points::Zero(terms.symmetry.carriers, 3),
          std::vector<Eigen::Matrix3d>(regions, Eigen::Matrix3d::Identity())};
}

Points symmetry_differences(const KurzTerms& terms, std::size_t demand, const KurzState& state) {
  const SymmetryDemand& each = terms.symmetry.demands[demand];
  return symmetry_differences(each, state.rotations, state.carriers,
                              each.points + terms.at_points[demand] * state.nodes,
                              each.images + terms.at_images[demand] * state.nodes);
}

KurzEnergy kurz_energy(const KurzTerms& terms, const Eigen::SparseMatrix<double>& plate, const DataTerm& data,
                       const KurzState& state) {
  KurzEnergy energy;
  if (terms.pulls.weights.size() > 0) {
    const Points left = terms.pulls.values * state.nodes - terms.pulls.offsets;
    energy.pulls = left.rowwise().squaredNorm().dot(terms.pulls.weights);
  }
  if (data.weights.size() > 0) {
    const Points left = data.values * state.nodes - data.offsets;
    energy.data = left.cwiseProduct(data.normals).rowwise().sum().array().square().matrix().dot(data.weights);
  }
  energy.thin_plate = terms.thin_plate * state.nodes.cwiseProduct(plate * state.nodes).sum();
  for (std::size_t d = 0; d < terms.symmetry.demands.size(); ++d) {
    energy.symmetry +=
        terms.symmetry_weight * terms.symmetry.demands[d].weight * symmetry_differences(terms, d, state).squaredNorm();
  }
  return energy;
}

namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d result;
  result << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return result;
}

struct Turn {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d side = Eigen::Vector3d::Zero();
  double scale = 0;  // of the matrix, were all turns determined
};

// d/d omega of (R O R^T a - b) with R <- exp(omega) R: omega x (M a) - M (omega x a).
void add(const KurzTerms& terms, std::size_t demand, const KurzState& state, Turn& turn) {
  const SymmetryDemand& each = terms.symmetry.demands[demand];
  const Eigen::Matrix3d linear = carried_linear(each, state.rotations);
  const int carrier = terms.symmetry.carrier_of_region[static_cast<std::size_t>(each.region)];
  Eigen::Vector3d centre = each.centre;
  if (carrier >= 0) centre += state.carriers.row(carrier).transpose();
  const Points arms = (each.points + terms.at_points[demand] * state.nodes).rowwise() - centre.transpose();
  const Points left = symmetry_differences(terms, demand, state);
  for (Eigen::Index i = 0; i < arms.rows(); ++i) {
    const Eigen::Vector3d arm = arms.row(i);
    const Eigen::Matrix3d slope = linear * cross_matrix(arm) - cross_matrix(linear * arm);
    turn.matrix += each.weight * slope.transpose() * slope;
    turn.side += each.weight * slope.transpose() * left.row(i).transpose();
    turn.scale += each.weight * arm.squaredNorm();
  }
}

Eigen::Vector3d step_of(const Turn& turn) {
  constexpr double kOpen = 1e-6;  // of the scale: smaller eigenvalues are rounding
  constexpr double kMax = 0.3;    // radians
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(turn.matrix);
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const double value = eigen.eigenvalues()[k];
    if (value <= kOpen * turn.scale) continue;
    const Eigen::Vector3d direction = eigen.eigenvectors().col(k);
    step -= direction.dot(turn.side) / value * direction;
  }
  return step * std::min(1.0, kMax / std::max(step.norm(), 1e-300));
}

}  // namespace

void turn_symmetries(const KurzTerms& terms, KurzState& state) {
  std::vector<Turn> turns(state.rotations.size());
  for (std::size_t d = 0; d < terms.symmetry.demands.size(); ++d) {
    const int region = terms.symmetry.demands[d].region;
    if (region >= 0) add(terms, d, state, turns[static_cast<std::size_t>(region)]);
  }
  for (std::size_t r = 0; r < turns.size(); ++r) {
    const Eigen::Vector3d step = step_of(turns[r]);
    const double angle = step.norm();
    if (angle == 0) continue;
    state.rotations[r] = nearest_orthogonal(axis_rotation(step / angle, angle) * state.rotations[r]);
  }
}

}  // namespace orbifit
