#include "kurz_ceres.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <ceres/ceres.h>

#include "orbifit/model/errors.h"

#include "thin_plate.h"

namespace orbifit {

namespace {

using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Jacobians = std::map<int, Jacobian>;  // by block of three unknowns: nodes, then carriers

// sum of J_b x_b + constant.
class LinearCost : public ceres::CostFunction {
 public:
  LinearCost(Jacobians&& jacobians, Eigen::VectorXd&& constant) : constant_(std::move(constant)) {
    for (auto& [block, jacobian] : jacobians) jacobians_.push_back(std::move(jacobian));
    set_num_residuals(static_cast<int>(constant_.size()));
    mutable_parameter_block_sizes()->assign(jacobians_.size(), 3);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> values(residuals, constant_.size());
    values = constant_;
    for (std::size_t b = 0; b < jacobians_.size(); ++b) {
      values += jacobians_[b] * Eigen::Map<const Eigen::Vector3d>(parameters[b]);
      if (jacobians == nullptr || jacobians[b] == nullptr) continue;
      std::copy_n(jacobians_[b].data(), jacobians_[b].size(), jacobians[b]);
    }
    return true;
  }

 private:
  std::vector<Jacobian> jacobians_;
  Eigen::VectorXd constant_;
};

using Add = std::function<void(Jacobians&&, Eigen::VectorXd&&)>;

void accumulate(Jacobians& jacobians, int block, const Jacobian& value) {
  const auto [place, fresh] = jacobians.try_emplace(block, value);
  if (!fresh) place->second += value;
}

// factor (x) the row of scalars.
void accumulate(Jacobians& jacobians, const SparseRows& values, Eigen::Index row, const Jacobian& factor) {
  for (SparseRows::InnerIterator each(values, row); each; ++each) {
    accumulate(jacobians, static_cast<int>(each.col()), each.value() * factor);
  }
}

void add_pulls(const PullTerm& pulls, const Add& add) {
  for (Eigen::Index i = 0; i < pulls.weights.size(); ++i) {
    const double root = std::sqrt(pulls.weights[i]);
    Jacobians jacobians;
    accumulate(jacobians, pulls.values, i, root * Eigen::Matrix3d::Identity());
    add(std::move(jacobians), -root * pulls.offsets.row(i).transpose());
  }
}

void add_data(const DataTerm& data, const Add& add) {
  for (Eigen::Index i = 0; i < data.weights.size(); ++i) {
    const double root = std::sqrt(data.weights[i]);
    Jacobians jacobians;
    accumulate(jacobians, data.values, i, root * data.normals.row(i));
    add(std::move(jacobians), Eigen::VectorXd::Constant(1, -root * data.normals.row(i).dot(data.offsets.row(i))));
  }
}

void add_thin_plate(const KurzTerms& terms, const Add& add) {
  const SparseRows rows = std::sqrt(terms.thin_plate) * thin_plate_rows(terms.grid);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    Jacobians jacobians;
    accumulate(jacobians, rows, i, Eigen::Matrix3d::Identity());
    if (!jacobians.empty()) add(std::move(jacobians), Eigen::Vector3d::Zero());
  }
}

void add_symmetry(const KurzTerms& terms, std::size_t number, const KurzState& state, const Add& add) {
  const SymmetryDemand& demand = terms.symmetry.demands[number];
  const double root = std::sqrt(terms.symmetry_weight * demand.weight);
  const Eigen::Matrix3d linear = carried_linear(demand, state.rotations);
  const Points none = Points::Zero(terms.symmetry.carriers, 3);
  const Points rest = root * symmetry_differences(demand, state.rotations, none, demand.points, demand.images);
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    Jacobians jacobians;
    accumulate(jacobians, terms.at_points[number], i, root * linear);
    accumulate(jacobians, terms.at_images[number], i, -root * Eigen::Matrix3d::Identity());
    for (const auto& [carrier, matrix] : carried_shift(demand, linear)) {
      accumulate(jacobians, terms.grid.node_count() + carrier, root * matrix);
    }
    add(std::move(jacobians), rest.row(i).transpose());
  }
}

void add_hold(const KurzTerms& terms, const KurzState& state, const Add& add) {
  const double root = std::sqrt(terms.hold);
  const auto nodes = static_cast<int>(state.nodes.rows());
  for (int b = 0; b < nodes + terms.symmetry.carriers; ++b) {
    const Eigen::Vector3d now = b < nodes ? state.nodes.row(b) : state.carriers.row(b - nodes);
    add({{b, root * Eigen::Matrix3d::Identity()}}, -root * now);
  }
}

void add_all(const KurzTerms& terms, const DataTerm& data, const KurzState& state, const Add& add) {
  add_pulls(terms.pulls, add);
  add_data(data, add);
  add_thin_plate(terms, add);
  for (std::size_t d = 0; d < terms.symmetry.demands.size(); ++d) add_symmetry(terms, d, state, add);
  add_hold(terms, state, add);
}

std::vector<double*> unknowns_of(const Jacobians& jacobians, KurzState& state) {
  const auto nodes = static_cast<int>(state.nodes.rows());
  std::vector<double*> unknowns;
  for (const auto& [block, unused] : jacobians) {
    unknowns.push_back(block < nodes ? &state.nodes(block, 0) : &state.carriers(block - nodes, 0));
  }
  return unknowns;
}

}  // namespace

void solve_with_ceres(const KurzTerms& terms, const DataTerm& data, KurzState& state) {
  ceres::Problem::Options problem_options;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  add_all(terms, data, state, [&](Jacobians&& jacobians, Eigen::VectorXd&& constant) {
    const std::vector<double*> unknowns = unknowns_of(jacobians, state);
    problem.AddResidualBlock(new LinearCost(std::move(jacobians), std::move(constant)), nullptr, unknowns);
  });
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  // The problem is linear: one step of Gauss and Newton, and one that refines it.
  options.initial_trust_region_radius = options.max_trust_region_radius = 1e16;
  options.max_num_iterations = 2;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw NoResultError("Ceres finds no solution: " + summary.message);
}

}  // namespace orbifit
