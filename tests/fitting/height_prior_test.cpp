#include "resolution/height_prior.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

#include "base/random.h"
#include "basis/subspace_parts.h"

namespace orbifit {
namespace {

class HeightPriorOf : public testing::TestWithParam<const char*> {
 protected:
  HeightPrior prior(double deviation, double length) const {
    return {quotient_, deviation * subspace_.diagonal(), length * subspace_.diagonal()};
  }

  RunContext context_;
  GeneratedModel model_ = generate(GetParam(), {{"detail", 1}});
  Subspace subspace_ = build_subspace(model_.mesh, model_.truth, {}, context_);
  QuotientSurface quotient_{subspace_, model_.mesh};
};

// Of each orbit once for each of its places: the areas of all are the mesh's.
TEST_P(HeightPriorOf, CountsEachOrbitOnce) {
  EXPECT_NEAR(quotient_.areas.sum(), face_areas(model_.mesh).sum(), 0.01 * face_areas(model_.mesh).sum());
  EXPECT_LE(quotient_.images.sum(), static_cast<double>(model_.mesh.vertices.rows()));
  EXPECT_LT((quotient_.stiffness * Eigen::VectorXd::Ones(quotient_.areas.size())).cwiseAbs().maxCoeff(), 1e-9);
}

// Where a surface is far wider than the length its heights have the deviation that was asked for; nowhere less but for
// the mesh's coarseness, and more on narrow parts, whose heights are few.
TEST_P(HeightPriorOf, HasTheDeviationThatWasAskedFor) {
  const HeightPrior wide = prior(0.01, 0.05);
  const Eigen::MatrixXd root = wide.root;
  const Eigen::MatrixXd covariance = (root.transpose() * wide.weights.asDiagonal() * root)
                                         .ldlt()
                                         .solve(Eigen::MatrixXd::Identity(root.cols(), root.cols()));
  const Eigen::VectorXd deviations = covariance.diagonal().cwiseSqrt() / (0.01 * subspace_.diagonal());
  EXPECT_GT(deviations.minCoeff(), 0.5);
  EXPECT_LT(deviations.minCoeff(), 1.5);
}

TEST_P(HeightPriorOf, IsSolvedAsDirectly) {
  const HeightPrior prior_of = prior(0.01, 0.03);
  Random random(4);
  Eigen::VectorXd known(quotient_.areas.size());
  Eigen::VectorXd side(known.size());
  for (Eigen::Index r = 0; r < known.size(); ++r) {
    known[r] = random.uniform() < 0.5 ? 0 : std::exp(random.uniform(-3, 3)) * prior_of.weights.mean();
    side[r] = random.normal();
  }
  const auto times = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return known.cwiseProduct(x) + prior_of.precision_times(x);
  };
  const Eigen::VectorXd found = solve_with_prior(prior_of, known, times, side, context_);
  const Eigen::MatrixXd root = prior_of.root;
  Eigen::MatrixXd all = root.transpose() * prior_of.weights.asDiagonal() * root;
  all.diagonal() += known;
  const Eigen::VectorXd expected = all.ldlt().solve(side);
  EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(Models, HeightPriorOf, testing::Values("table", "chair"));

}  // namespace
}  // namespace orbifit
