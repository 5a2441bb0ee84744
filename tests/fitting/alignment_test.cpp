#include "registration/alignment.h"

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"

#include "base/random.h"
#include "registration/correspondences.h"

namespace orbifit {
namespace {

double worst_offset(const Similarity& a, const Similarity& b, const Points& points) {
  double worst = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    worst = std::max(worst, (a(points.row(i).transpose()) - b(points.row(i).transpose())).norm());
  }
  return worst / diagonal(points);
}

Similarity random_similarity(Random& random, double scale, double angle, double shift) {
  return {scale, axis_rotation(random.direction(), angle), shift * random.direction()};
}

TEST(Alignment, LandmarksGiveTheSimilarityBack) {
  const Mesh mesh = generate("chair").mesh;
  Random random(2);
  const Similarity truth = random_similarity(random, 2.5, 2.2, 4);
  std::vector<Landmark> landmarks;
  for (const int vertex : {3, 700, 4000, 9000}) {
    landmarks.push_back({vertex, truth(mesh.vertices.row(vertex).transpose())});
  }
  EXPECT_LT(worst_offset(align_landmarks(mesh, landmarks), truth, mesh.vertices), 1e-12);
}

TEST(Alignment, FewLandmarksGiveATranslation) {
  const Mesh mesh = generate("chair").mesh;
  const Eigen::Vector3d shift(1, 2, 3);
  const Similarity found = align_landmarks(
      mesh, {{5, mesh.vertices.row(5).transpose() + shift}, {90, mesh.vertices.row(90).transpose() + shift}});
  EXPECT_LT(worst_offset(found, {1, Eigen::Matrix3d::Identity(), shift}, mesh.vertices), 1e-12);
}

class RigidAlignment : public testing::TestWithParam<int> {};

// The truth perturbed by less than half the distance between slats, beyond which one slat is taken for the next.
TEST_P(RigidAlignment, FindsASmallMotionFromOneSide) {
  const Mesh mesh = generate("chair").mesh;
  RunContext context;
  Random random(static_cast<std::uint64_t>(GetParam()));
  const Similarity truth = random_similarity(random, 1, 0.06, 0.03);
  ScanOptions options;
  options.views = 2;
  PointCloud scan = virtual_scan(mesh, options, context);
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    scan.points.row(i) = truth(scan.points.row(i).transpose()).transpose();
  }
  scan.viewpoints.resize(0, 3);
  const PreparedScan prepared = prepare_scan(scan, {}, context);
  EXPECT_LT(worst_offset(align_rigidly(MatchSurface(mesh), prepared, Similarity{}, context), truth, mesh.vertices),
            2e-3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RigidAlignment, testing::Values(1, 2, 3, 4));

TEST(Alignment, TemplateFrameIsTheInverseOfThePose) {
  Random random(8);
  const Similarity pose = random_similarity(random, 0.3, 1.1, 5);
  const Mesh mesh = generate("bar").mesh;
  Points posed = mesh.vertices;
  for (Eigen::Index i = 0; i < posed.rows(); ++i) posed.row(i) = pose(posed.row(i).transpose()).transpose();
  EXPECT_LT((to_template(pose, posed) - mesh.vertices).norm(), 1e-10);
}

TEST(Correspondences, OfPointsBesideAFlatFaceAreTheirFeet) {
  Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  Points points(4, 3);
  points << 0.2, 0.2, 0.1, 0.2, 0.2, -0.3, 0.2, 0.2, 0.2, 0.2, 0.2, 5;
  Points normals(4, 3);
  normals << 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1;  // the third does not face the triangle, the fourth is too far
  CorrespondenceOptions options;
  options.max_distance = 1;
  options.robust_scale = 0.1;
  options.trim = 1;
  const auto pairs = find_correspondences(MatchSurface(mesh), points, normals, options, RunContext{});
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].scan_point, 0);
  EXPECT_NEAR(pairs[0].distance, 0.1, 1e-15);
  EXPECT_NEAR(pairs[0].weight, 0.25, 1e-12);  // 1 / (1 + 1)^2
  EXPECT_EQ(pairs[1].scan_point, 1);
  options.trim = 0.5;
  EXPECT_EQ(find_correspondences(MatchSurface(mesh), points, normals, options, RunContext{}).size(), 1U);
  options.trim = 1;
  options.every = 2;
  const auto even = find_correspondences(MatchSurface(mesh), points, normals, options, RunContext{});
  ASSERT_EQ(even.size(), 1U);
  EXPECT_EQ(even[0].scan_point, 0);
  options.every = 3;  // the first and the fourth
  points.row(3) << 0.2, 0.2, 0.3;
  const auto third = find_correspondences(MatchSurface(mesh), points, normals, options, RunContext{});
  ASSERT_EQ(third.size(), 2U);
  EXPECT_EQ(third[1].scan_point, 3);
  EXPECT_NEAR(third[1].distance, 0.3, 1e-15);
}

TEST(Correspondences, AcrossAnEdgePointAwayFromIt) {
  Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  Points points(1, 3);
  points << 0.3, -0.5, 0;
  Points normals(1, 3);
  normals << 0, 0, 1;
  CorrespondenceOptions options;
  options.max_distance = 1;
  options.robust_scale = 1;
  options.direction_noise = 1e-6;
  const auto pairs = find_correspondences(MatchSurface(mesh), points, normals, options, RunContext{});
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_GT(std::abs(pairs[0].normal.y()), 0.999);
}

TEST(RobustWeight, IsTheSlopeOfTheErrorOverTheSquaredDistance) {
  for (const double distance : {0.0, 0.01, 0.3, 2.0, 50.0}) {
    constexpr double kScale = 0.4;
    constexpr double kStep = 1e-6;
    const double squared = distance * distance + kStep;  // away from 0, where there is no square root
    const double slope =
        (robust_error(std::sqrt(squared + kStep), kScale) - robust_error(std::sqrt(squared - kStep), kScale)) /
        (2 * kStep);
    EXPECT_NEAR(robust_weight(std::sqrt(squared), kScale), slope, 1e-5);
    EXPECT_LE(robust_error(distance, kScale), kScale * kScale);
  }
}

TEST(Correspondences, DoNotDependOnTheFacesTakenForLikely) {
  Random random(4);
  const Mesh mesh = generate("chair").mesh;
  const double size = diagonal(mesh.vertices);
  Points points(500, 3);
  Points normals(500, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto vertex = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(mesh.vertices.rows())));
    points.row(i) = mesh.vertices.row(vertex) + 0.02 * size * random.direction().transpose();
    normals.row(i) = random.direction().transpose();
  }
  CorrespondenceOptions options;
  options.max_distance = 0.1 * size;
  options.robust_scale = 0.1 * size;
  const MatchSurface surface(mesh);
  const auto expected = find_correspondences(surface, points, normals, options, RunContext{});
  std::vector<int> likely(500);
  for (int& face : likely) face = static_cast<int>(random.below(static_cast<std::uint64_t>(mesh.faces.rows())));
  for (int round = 0; round < 2; ++round) {  // with any faces, then with those found
    const auto pairs = find_correspondences(surface, points, normals, options, RunContext{}, &likely);
    ASSERT_EQ(pairs.size(), expected.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_EQ(pairs[i].face, expected[i].face);
      EXPECT_EQ(pairs[i].distance, expected[i].distance);
    }
  }
}

}  // namespace
}  // namespace orbifit
