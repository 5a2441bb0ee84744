#include "basis/lift.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "basis/alike_points.h"
#include "basis/plain_lift.h"
#include "basis/subspace_parts.h"
#include "subspaces.h"

namespace orbifit {
namespace {

Points random_points(int count, Random& random) {
  Points points(count, 3);
  for (double& coordinate : points.reshaped()) coordinate = random.uniform(-1, 1);
  return points;
}

TEST(Lift, IsAPartitionOfUnity) {
  Random random(5);
  const LiftWeights weights = lift_weights(random_points(500, random), random_points(40, random), 0.3, RunContext{});
  for (Eigen::Index row = 0; row < weights.rows(); ++row) {
    EXPECT_NEAR(weights.row(row).sum(), 1, 1e-14);
    for (LiftWeights::InnerIterator entry(weights, row); entry; ++entry) EXPECT_GT(entry.value(), 0);
  }
}

TEST(Lift, PointsOutOfReachFollowTheNearestSample) {
  Random random(6);
  Points samples = random_points(10, random);
  Points far(1, 3);
  far << 100, 0, 0;
  const LiftWeights weights = lift_weights(far, samples, 0.1, RunContext{});
  int nearest = 0;
  (samples.rowwise() - far.row(0)).rowwise().norm().minCoeff(&nearest);
  EXPECT_EQ(weights.nonZeros(), 1);
  EXPECT_EQ(weights.coeff(0, nearest), 1);
}

TEST(Lift, IsContinuousWhereAGaussianIsCutOff) {
  Points samples(2, 3);
  samples << 0, 0, 0, 3, 0, 0;
  const double cut = std::sqrt(-2 * std::log(0.001));
  Points points(2, 3);
  points << cut - 1e-7, 0, 0, cut + 1e-7, 0, 0;
  const LiftWeights weights = lift_weights(points, samples, 1, RunContext{});
  EXPECT_NEAR(weights.coeff(0, 0), weights.coeff(1, 0), 1e-6);
}

TEST(Lift, DoesNotDependOnThreads) {
  Random random(7);
  const Points points = random_points(3000, random);
  const Points samples = random_points(100, random);
  RunContext two;
  two.threads = 2;
  const LiftWeights a = lift_weights(points, samples, 0.3, RunContext{});
  const LiftWeights b = lift_weights(points, samples, 0.3, two);
  EXPECT_EQ(Eigen::MatrixXd(a), Eigen::MatrixXd(b));
}

// Of an orbit's points those that stand for others give the same mean as all of them.
TEST(Lift, PointsStandForTheirImagesUnderTheWhole) {
  for (const std::string name : {"table", "chair", "car"}) {
    const GeneratedModel model = generate(name);
    const Subspace subspace = subspace_of(model, GroupMode::floating, 0.06);
    const Eigen::VectorXd q = random_state(subspace, 0.1).q;
    const Points samples = sample_displacements(subspace, q);
    const Eigen::VectorXd carriers = subspace->basis.carried * q;
    const VertexOrbits& orbits = subspace->orbits;
    const std::vector<int> stood_for =
        points_stood_for(subspace->sampling, *subspace->regions, *subspace->words, carriers, orbits);
    EXPECT_GT(std::ranges::count(stood_for, 0), orbits.representatives()) << name;

    const PlainLift plain(subspace->sampling, *subspace->regions, true);
    subspace->regions->prepare(RunContext{});
    PlainLift::Scratch scratch;
    for (int r = 0; r < orbits.representatives(); r += 97) {
      Eigen::Vector3d all = Eigen::Vector3d::Zero();
      Eigen::Vector3d some = Eigen::Vector3d::Zero();
      int count = 0;
      const auto at = static_cast<std::size_t>(r);
      for (auto k = orbits.first_point[at]; k < orbits.first_point[at + 1]; ++k) {
        const auto point = static_cast<std::size_t>(k);
        const int word = orbits.point_words[point];
        const Transport& transport = subspace->words->transport(word);
        plain.terms(subspace->words->motion(word)(orbits.positions.row(r).transpose()), orbits.point_sets[point],
                    scratch);
        Eigen::Vector3d u = Eigen::Vector3d::Zero();
        for (const LiftTerm& term : scratch.terms) u += term.weight * samples.row(term.sample).transpose();
        for (const auto& [carrier, matrix] : transport.carried) u -= matrix * carriers.segment<3>(3 * carrier);
        all += transport.frame.transpose() * u;
        some += stood_for[point] * (transport.frame.transpose() * u);
        count += stood_for[point];
      }
      EXPECT_EQ(count, orbits.first_point[at + 1] - orbits.first_point[at]);
      EXPECT_LT((all - some).norm() / count, 1e-7 * subspace->diagonal) << name << ", representative " << r;
    }
  }
}

}  // namespace
}  // namespace orbifit
