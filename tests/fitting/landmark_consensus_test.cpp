#include "registration/landmark_consensus.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

#include "base/random.h"

namespace orbifit {
namespace {

constexpr double kTolerance = 0.12;

struct Said {
  Mesh mesh = generate("chair").mesh;
  Similarity pose{2.5, axis_rotation(Eigen::Vector3d(1, 2, 3).normalized(), 2), {4, -1, 7}};
  std::vector<Landmark> landmarks;
};

// Landmarks of another chair, of which the first are off by much.
Said landmarks_of(int count, int wrong) {
  Said said;
  const Mesh other = generate("chair", {{"seat_width", 0.5}, {"leg_height", 0.5}, {"back_height", 0.55}}).mesh;
  Random random(7);
  for (int i = 0; i < count; ++i) {
    const auto vertex = static_cast<int>(random.below(static_cast<std::uint64_t>(other.vertices.rows())));
    Eigen::Vector3d target = said.pose(other.vertices.row(vertex).transpose());
    if (i < wrong) target += (0.3 + random.uniform()) * 2.5 * diagonal(other.vertices) * random.direction();
    said.landmarks.push_back({vertex, target});
  }
  return said;
}

class WrongLandmarks : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(WrongLandmarks, AreTold) {
  const auto [count, wrong] = GetParam();
  const Said said = landmarks_of(count, wrong);
  const LandmarkConsensus found = landmark_consensus(said.mesh, said.landmarks, kTolerance);
  for (int i = 0; i < count; ++i) EXPECT_EQ(found.agrees[static_cast<std::size_t>(i)] != 0, i >= wrong) << i;
  EXPECT_TRUE(found.determined);
  EXPECT_LT(found.largest_residual, kTolerance);
  EXPECT_NEAR(std::log(found.pose.scale / said.pose.scale), 0, 0.2);
  EXPECT_LT(axis_angle(found.pose.linear * said.pose.linear.transpose()).angle, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Landmarks, WrongLandmarks,
                         testing::Values(std::pair{4, 0}, std::pair{5, 1}, std::pair{9, 3}, std::pair{40, 15}));

TEST(LandmarkConsensus, BelievesThreeThatNothingContradicts) {
  const Said said = landmarks_of(3, 1);
  const LandmarkConsensus found = landmark_consensus(said.mesh, said.landmarks, kTolerance);
  EXPECT_EQ(found.agrees, std::vector<char>(3, 1));
}

TEST(LandmarkConsensus, IsNotDeterminedByLandmarksOnALineOrOnTopOfOneAnother) {
  Said said = landmarks_of(4, 0);
  const auto determined = [&] { return landmark_consensus(said.mesh, said.landmarks, kTolerance).determined; };
  EXPECT_TRUE(determined());
  for (Landmark& each : said.landmarks) each.target = Eigen::Vector3d(1, 2, 3);
  EXPECT_FALSE(determined());
  for (std::size_t i = 0; i < 4; ++i) said.landmarks[i].target = static_cast<double>(i) * Eigen::Vector3d(1, 2, 3);
  EXPECT_FALSE(determined());
  said.landmarks.resize(2);
  EXPECT_FALSE(determined());
}

}  // namespace
}  // namespace orbifit
