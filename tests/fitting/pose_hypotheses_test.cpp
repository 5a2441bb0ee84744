#include "pose_hypotheses.h"

#include <cmath>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

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
                         double worst = 0;
                         for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
                           const Eigen::Vector3d vertex = mesh.vertices.row(v);
                           worst = std::max(worst, (pose(vertex) - truth(vertex)).norm());
                         }
                         nearest = std::min(nearest, worst / (size * truth.scale));
                       });
  }
  EXPECT_GT(proposed, 0);
  EXPECT_LT(nearest, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Hypotheses, testing::Values(1, 2, 3, 4));

}  // namespace
}  // namespace orbifit
