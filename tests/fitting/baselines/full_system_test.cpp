#include "full_system.h"

#include <gtest/gtest.h>

#include "orbifit/baselines/svd_nullspace.h"
#include "orbifit/baselines/symmetry_constraints.h"
#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/subspace/deformer.h"

#include "basis/subspace_parts.h"
#include "random_pulls.h"
#include "solver/fit_system.h"

namespace orbifit {
namespace {

using Eigen::VectorXd;

SubspaceOptions plain_options(GroupMode mode) {
  SubspaceOptions options;
  options.mode = mode;
  options.lift = LiftKind::paper;
  options.samples = 120;
  return options;
}

// A template with random points beside its surface, which pull it there.
class FullSampling : public testing::TestWithParam<ModelCase> {
 protected:
  FullSampling()
      : model_(generate(GetParam().model)),
        subspace_(build_subspace(model_.mesh, model_.truth, plain_options(GetParam().mode), context_)),
        size_(diagonal(model_.mesh.vertices)),
        data_(model_.mesh, random_) {
    around_.resize(subspace_.degrees_of_freedom());
    for (double& value : around_) value = 0.01 * size_ * random_.uniform(-1, 1);
  }

  static constexpr double kDamping = 0.2;

  // One solve turned to, and held around, `around_`.
  Points solved(FullSymmetry symmetry, double weight = 1, double damping = kDamping) const {
    FullSystem system(subspace_, model_.mesh, 0.3, symmetry, weight);
    VectorXd around = VectorXd::Zero(system.unknowns());
    around.head(subspace_->basis.columns.rows()) = subspace_->basis.columns * around_;
    if (symmetry != FullSymmetry::none)
      around.tail(subspace_->basis.carried.rows()) = subspace_->basis.carried * around_;
    system.rotate(around);
    return system.samples_at(
        system.solve(data_.pairs, 0.4, data_.points, data_.pulls, {0.3, damping, around}, context_).q);
  }

  Points ours(double damping = kDamping) const {
    FitSystem system(subspace_, model_.mesh, 0.3);
    system.rotate(around_);
    return system.samples_at(
        system.solve(data_.pairs, 0.4, data_.points, data_.pulls, {0.3, damping, around_}, context_).q);
  }

  double distance(const Points& a, const Points& b) const { return (a - b).rowwise().norm().maxCoeff() / size_; }

  // The first vertex of each eighth of them goes somewhere, the others hold.
  std::vector<Handle> handles() const {
    std::vector<Handle> result;
    for (int k = 0; k < 8; ++k) {
      Handle handle;
      handle.vertices = {k * static_cast<int>(model_.mesh.vertices.rows()) / 8};
      if (k % 3 == 0) handle.motion.translation = size_ * Eigen::Vector3d(0.03, 0.05, 0.1);
      result.push_back(handle);
    }
    return result;
  }

  RunContext context_;
  GeneratedModel model_;
  Subspace subspace_;
  double size_;
  Random random_{7};
  RandomPulls data_;
  VectorXd around_;
};

// Groups that float add coordinates whose length the two count differently. Without damping that matters alone to what
// prefers the pose to a shift of all samples, which is no different to the data.
TEST_P(FullSampling, ConstrainedSolutionIsOurs) {
  const bool same_lengths = GetParam().mode == GroupMode::fixed;
  const double damping = same_lengths ? kDamping : 0;
  const auto compared = [&](const Points& moved) -> Points {
    return same_lengths ? moved : Points(moved.rowwise() - moved.colwise().mean());
  };
  const Points expected = compared(ours(damping));
  ASSERT_GT(expected.rowwise().norm().maxCoeff(), 1e-3 * size_);
  const Points found = compared(solved(FullSymmetry::constrained, 1, damping));
  EXPECT_LT(distance(found, expected), same_lengths ? 1e-8 : 1e-5);
  EXPECT_GT(distance(compared(solved(FullSymmetry::none, 1, damping)), expected), 1e-2);
}

TEST_P(FullSampling, SoftSolutionTendsToTheConstrainedOne) {
  const Points exact = solved(FullSymmetry::constrained);
  std::vector<double> distances;
  for (const double weight : {1e-2, 1e2, 1e4, 1e6})
    distances.push_back(distance(solved(FullSymmetry::soft, weight), exact));
  EXPECT_GT(distances.front(), 1e-3);
  EXPECT_LT(distances[2], 0.02 * distances[1]);
  EXPECT_LT(distances[3], 0.02 * distances[2]);
}

TEST_P(FullSampling, EditsAreOursToRounding) {
  FullSamplingOptions options;
  options.fit.subspace = plain_options(GetParam().mode);
  const FitInput input{model_.mesh, model_.truth, PointCloud{}, Similarity{}, {}, handles()};
  const FitResult result = fit_full_sampling(input, options, context_);
  Deformer deformer(subspace_, model_.mesh, {.contacts = false});  // the baselines know none
  deformer.set_handles(input.handles, options.alpha);
  std::vector<Motion> motions;
  for (const Handle& handle : input.handles) motions.push_back(handle.motion);
  const VectorXd q = deformer.solve(motions, options.edit_iterations).state.q;
  const Points moved = Eigen::Map<const Points>(result.q.data(), result.samples, 3);
  ASSERT_GT(moved.rowwise().norm().maxCoeff(), 1e-2 * size_);
  EXPECT_LT(distance(moved, sample_displacements(subspace_, q)), 1e-8);
  EXPECT_LT(result.field_residual, 1e-12);
  SvdNullspaceOptions dense;
  dense.fit.subspace = options.fit.subspace;
  const FitResult other = fit_svd_nullspace(input, dense, context_);
  EXPECT_LT(distance(other.fitted.vertices, result.fitted.vertices), 1e-7);
}

TEST_P(FullSampling, FitsAreTheSameWithTwoThreadsAndKeepWhatTheyShall) {
  const PointCloud scan = virtual_scan(model_.mesh, {}, context_);
  const FitInput input{model_.mesh, model_.truth, scan, Similarity{}, {}, {}};
  RunContext two;
  two.threads = 2;
  for (const FullSymmetry symmetry : {FullSymmetry::none, FullSymmetry::soft, FullSymmetry::constrained}) {
    FullSamplingOptions options;
    options.fit.subspace = plain_options(GetParam().mode);
    options.fit.levels = 3;
    options.fit.max_iterations = 10;
    options.fit.scan_points = 500;
    options.symmetry = symmetry;
    const FitResult result = fit_full_sampling(input, options, context_);
    EXPECT_TRUE(result.converged) << result.stopped_because;
    EXPECT_EQ(fit_full_sampling(input, options, two).fitted.vertices, result.fitted.vertices);
    EXPECT_GT(result.iterations.front().seconds, 0);
    if (symmetry == FullSymmetry::constrained) {
      EXPECT_LT(result.field_residual, 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, FullSampling,
                         testing::Values(ModelCase{"bar", GroupMode::fixed}, ModelCase{"bar", GroupMode::floating},
                                         ModelCase{"table", GroupMode::fixed},
                                         ModelCase{"chair", GroupMode::floating}));

}  // namespace
}  // namespace orbifit
