#include "placement/pose_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

#include "poses_apart.h"

namespace orbifit {
namespace {

class Hypotheses : public testing::TestWithParam<int> {};

TEST_P(Hypotheses, OfTwoPointsOfThePosedTemplateHoldItsPose) {
  Random random(static_cast<std::uint64_t>(GetParam()));
  const Mesh mesh = generate("chair").mesh;
  const SurfaceSamples samples = sample_surface(mesh, 60, random);
  const double size = diagonal(mesh.vertices);
  const Similarity truth{std::exp(random.uniform(-2, 2)), random.rotation(), 5 * random.direction()};
  const PoseHypotheses hypotheses(samples);
  int proposed = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 40; ++k) {
    const auto i = static_cast<Eigen::Index>(random.below(60));
    const auto j = static_cast<Eigen::Index>(random.below(60));
    if ((samples.points.row(i) - samples.points.row(j)).norm() < 0.3 * size) continue;
    const auto normal = [&](Eigen::Index at) -> Eigen::Vector3d {
      return truth.linear * samples.normals.row(at).transpose();
    };
    hypotheses.propose(truth(samples.points.row(i)), normal(i), truth(samples.points.row(j)), normal(j), 400, random,
                       [&](const Similarity& pose) {
                         ++proposed;
                         nearest = std::min(nearest, poses_apart(mesh.vertices, pose, truth));
                       });
  }
  EXPECT_GT(proposed, 0);
  EXPECT_LT(nearest, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Hypotheses, testing::Values(1, 2, 3, 4));

}  // namespace
}  // namespace orbifit
