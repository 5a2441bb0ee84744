#include "full_system.h"

#include <ostream>

#include <gtest/gtest.h>

#include "orbifit/baselines/svd_nullspace.h"
#include "orbifit/baselines/symmetry_constraints.h"
#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/model/random.h"
#include "orbifit/model/sampling.h"
#include "orbifit/subspace/deformer.h"

#include "fit_system.h"

namespace orbifit {
namespace {

using Eigen::VectorXd;

struct Case {
  const char* model;
  GroupMode mode;
};

std::ostream& operator<<(std::ostream& out, const Case& each) {
  return out << each.model << "_" << to_string(each.mode);
}

SubspaceOptions plain_options(GroupMode mode) {
  SubspaceOptions options;
  options.mode = mode;
  options.lift = LiftKind::paper;
  options.samples = 120;
  return options;
}

// A template with random points beside its surface, which pull it there.
class FullSampling : public testing::TestWithParam<Case> {
 protected:
  FullSampling()
      : model_(generate(GetParam().model)),
        subspace_(build_subspace(model_.mesh, model_.truth, plain_options(GetParam().mode), context_)),
        size_(diagonal(model_.mesh.vertices)) {
    Random random(7);
    const SurfaceSamples samples = sample_surface(model_.mesh, 700, random);
    points_ = samples.points;
    for (Eigen::Index i = 0; i < points_.rows(); ++i) {
      Correspondence pair;
      pair.scan_point = static_cast<int>(i);
      pair.face = samples.faces[static_cast<std::size_t>(i)];
      pair.barycentric = Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform());
      pair.barycentric /= pair.barycentric.sum();
      pair.normal = random.direction();
      pair.weight = random.uniform();
      pairs_.push_back(pair);
      points_.row(i) += 0.05 * size_ * random.direction().transpose();
    }
    pulls_.push_back({3, model_.mesh.vertices.row(3).transpose() + 0.1 * size_ * random.direction(), 4});
    around_.resize(subspace_.degrees_of_freedom());
    for (double& value : around_) value = 0.01 * size_ * random.uniform(-1, 1);
  }

  // One solve turned to, and held around, `around_`.
  Points solved(FullSymmetry symmetry, double weight = 1) const {
    FullSystem system(subspace_, model_.mesh, 0.3, symmetry, weight);
    VectorXd around = VectorXd::Zero(system.unknowns());
    around.head(subspace_.basis.columns.rows()) = subspace_.basis.columns * around_;
    if (symmetry != FullSymmetry::none) around.tail(subspace_.basis.carried.rows()) = subspace_.basis.carried * around_;
    system.rotate(around);
    return system.samples_at(system.solve(pairs_, 0.4, points_, pulls_, {0.3, 0.2, around}, context_).q);
  }

  Points ours() const {
    FitSystem system(subspace_, model_.mesh, 0.3);
    system.rotate(around_);
    return system.samples_at(system.solve(pairs_, 0.4, points_, pulls_, {0.3, 0.2, around_}, context_).q);
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
  Points points_;
  std::vector<Correspondence> pairs_;
  std::vector<Pull> pulls_;
  VectorXd around_;
};

// Groups that float add coordinates whose length the two count differently, which matters to what holds and damps.
TEST_P(FullSampling, ConstrainedSolutionIsOursWhereLengthsAreTheSame) {
  const Points expected = ours();
  ASSERT_GT(expected.rowwise().norm().maxCoeff(), 1e-3 * size_);
  if (GetParam().mode == GroupMode::fixed) {
    EXPECT_LT(distance(solved(FullSymmetry::constrained), expected), 1e-8);
  } else {
    EXPECT_GT(distance(solved(FullSymmetry::none), expected), 1e-2);
  }
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
  Deformer deformer(subspace_, model_.mesh);
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
    options.fit.most_iterations = 10;
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
                         testing::Values(Case{"bar", GroupMode::fixed}, Case{"bar", GroupMode::floating},
                                         Case{"table", GroupMode::fixed}, Case{"chair", GroupMode::floating}));

}  // namespace
}  // namespace orbifit
