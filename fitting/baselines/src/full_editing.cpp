#include "full_editing.h"

#include <chrono>
#include <utility>

#include "orbifit/baselines/symmetry_constraints.h"

#include "basis/subspace_parts.h"
#include "deformation/corotation.h"
#include "deformation/handle_rows.h"
#include "for_each_coordinate.h"
#include "plain_weights.h"
#include "saddle_system.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

constexpr double kEditHold = 1e-12;  // as Deformer's

// Lower half of (K (x) I_3) + hold among more unknowns.
Sparse system_of(const Sparse& scalar, Index unknowns) {
  const VectorXd hold = VectorXd::Constant(unknowns, kEditHold * scalar.diagonal().mean());
  return lower_for_each_coordinate(scalar, unknowns) + Sparse(hold.asDiagonal());
}

}  // namespace

VectorXd edit_full_sampling(const Subspace& subspace, const Mesh& mesh, const std::vector<Handle>& handles,
                            const FullSamplingOptions& options, FitResult& record) {
  const Points& samples = subspace->sampling.points;
  const SampleEdges edges = neighbour_graph(samples, subspace->sampling.radii);
  const Corotation energy = corotation(samples, edges, graph_laplacian(edges, samples.rows()));
  const HandleRows rows(handles, subspace, mesh);
  const LiftWeights all = plain_weights(subspace);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < rows.vertices().size(); ++i) {
    for (LiftWeights::InnerIterator entry(all, rows.vertices()[i]); entry; ++entry) {
      entries.emplace_back(static_cast<Index>(i), entry.col(), entry.value());
    }
  }
  Sparse lift(static_cast<Index>(rows.vertices().size()), samples.rows());
  lift.setFromTriplets(entries.begin(), entries.end());
  const Eigen::Map<const VectorXd> weights(rows.weights().data(), static_cast<Index>(rows.weights().size()));
  const Sparse weighted = VectorXd(options.alpha * weights).asDiagonal() * lift;

  // Equation (4), left.
  Sparse scalar = energy.laplacian.transpose() * energy.laplacian;
  scalar += Sparse(lift.transpose() * weighted);
  const bool symmetric = options.symmetry != FullSymmetry::none;
  const Sparse constraints = symmetric ? symmetry_constraints(subspace) : Sparse(0, 3 * samples.rows());
  const Index unknowns = constraints.cols();
  Sparse system = system_of(scalar, unknowns);
  if (options.symmetry == FullSymmetry::soft && constraints.rows() > 0) {
    const double weight =
        options.weight * 3 * static_cast<double>(samples.rows()) / static_cast<double>(constraints.rows());
    const Sparse gram = constraints.transpose() * constraints;
    system += weight * Sparse(gram.triangularView<Eigen::Lower>());
    for (Index i = 3 * samples.rows(); i < unknowns; ++i) system.coeffRef(i, i) += kEditHold * weight;
  }
  const bool hard = options.symmetry == FullSymmetry::constrained;
  SaddleSystem saddle(hard ? constraints : Sparse(0, unknowns));
  saddle.factorise(system, Eigen::MatrixXd(unknowns, 0), Eigen::MatrixXd(0, 0));

  std::vector<Motion> motions;
  for (const Handle& handle : handles) motions.push_back(handle.motion);
  const VectorXd targets = rows.targets(motions);
  const Points handle_pull = weighted.transpose() * Eigen::Map<const Points>(targets.data(), targets.size() / 3, 3);
  std::vector<Eigen::Matrix3d> rotations(energy.neighbours.size(), Eigen::Matrix3d::Identity());
  VectorXd solved = VectorXd::Zero(unknowns);
  for (int iteration = 0; iteration < options.edit_iterations; ++iteration) {
    const auto start = std::chrono::steady_clock::now();
    // Equation (4), right, with the Laplace coordinates turned.
    VectorXd right = VectorXd::Zero(unknowns);
    right.head(samples.size()) = stacked(corotated_pull(energy, rotations) + handle_pull);
    const VectorXd before = std::exchange(solved, saddle.solve(right));
    const Points moved = Eigen::Map<const Points>(solved.data(), samples.rows(), 3);
    const Points previous = Eigen::Map<const Points>(before.data(), samples.rows(), 3);
    FitIteration entry;
    entry.stiffness = 1;
    entry.energy = laplace_energy(energy, rotations, moved);
    entry.change = (moved - previous).rowwise().norm().maxCoeff() / subspace->diagonal;
    rotations = local_rotations(energy, samples + moved, rotations);
    entry.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    record.iterations.push_back(entry);
  }
  if (options.fit.condition) record.condition = saddle.condition();
  return solved;
}

}  // namespace orbifit
