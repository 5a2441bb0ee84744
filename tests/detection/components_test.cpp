#include "surface/components.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "shapes.h"

namespace orbifit {
namespace {

// The same surface cut differently: every face split at its centroid, starting from the last.
Mesh recut(const Mesh& mesh) {
  Mesh result = mesh;
  result.faces.resize(3 * mesh.faces.rows(), 3);
  result.vertices.conservativeResize(mesh.vertices.rows() + mesh.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Index from = mesh.faces.rows() - 1 - f;
    const auto centre = static_cast<int>(mesh.vertices.rows() + f);
    result.vertices.row(centre) = (mesh.vertices.row(mesh.faces(from, 0)) + mesh.vertices.row(mesh.faces(from, 1)) +
                                   mesh.vertices.row(mesh.faces(from, 2))) /
                                  3;
    for (int k = 0; k < 3; ++k) {
      result.faces.row(3 * f + k) << mesh.faces(from, k), mesh.faces(from, (k + 1) % 3), centre;
    }
  }
  return result;
}

void expect_carried(const PreparedMesh& prepared, const ComponentSurvey& survey) {
  for (const CongruenceClass& each : survey.classes) {
    const auto& first = survey.moments[static_cast<std::size_t>(each.members.front())];
    for (std::size_t i = 0; i < each.members.size(); ++i) {
      const auto& other = survey.moments[static_cast<std::size_t>(each.members[i])];
      EXPECT_LT((each.motions[i](first.centroid) - other.centroid).norm(), 1e-3);
      const Eigen::Matrix3d carried = each.motions[i].linear * first.covariance * each.motions[i].linear.transpose();
      EXPECT_LT((carried - other.covariance).norm(), 1e-4);
    }
  }
  (void)prepared;
}

TEST(SurveyComponents, FindsCopiesHoweverPlacedAndCut) {
  Random random(2);
  const Mesh part = test::scalene();
  std::vector<Mesh> parts;
  for (int i = 0; i < 4; ++i) {
    const Motion motion{random.rotation(), 3 * random.direction() + Eigen::Vector3d(4 * i, 0, 0)};
    parts.push_back(test::moved(i % 2 == 0 ? part : recut(part), motion));
  }
  parts.push_back(test::moved(test::box(1, 0.5, 0.3), test::shift(0, 9, 0)));
  const Mesh mesh = test::joined(parts);
  const PreparedMesh prepared = prepare(mesh);
  const ComponentSurvey survey = survey_components(prepared, 0.002, 0, RunContext{});
  ASSERT_EQ(survey.classes.size(), 2U);
  for (const CongruenceClass& each : survey.classes) {
    if (each.members.size() == 1) continue;
    EXPECT_EQ(each.members, (std::vector<int>{0, 1, 2, 3}));
    for (const Motion& motion : each.motions) EXPECT_GT(motion.linear.determinant(), 0);
  }
  expect_carried(prepared, survey);
}

TEST(SurveyComponents, MirrorImagesOfChiralPartsNeedAReflection) {
  const Mesh part = test::scalene();
  const Mesh image = test::moved(part, Motion::reflection({1, 0.2, 0}, {-1, 0, 0}));
  const PreparedMesh prepared = prepare(test::joined({part, image, recut(test::moved(image, test::shift(0, 3, 0)))}));
  const ComponentSurvey survey = survey_components(prepared, 0.002, 0, RunContext{});
  ASSERT_EQ(survey.classes.size(), 1U);
  ASSERT_EQ(survey.classes[0].members.size(), 3U);
  EXPECT_LT(survey.classes[0].motions[1].linear.determinant(), 0);
  EXPECT_LT(survey.classes[0].motions[2].linear.determinant(), 0);
  expect_carried(prepared, survey);
}

TEST(SurveyComponents, LikeSizeIsNotCongruence) {
  const PreparedMesh prepared =
      prepare(test::joined({test::box(1, 1, 2), test::moved(test::box(1, 1.2, 2), test::shift(3, 0, 0)),
                            test::moved(test::box(1, 1, 2.2), test::shift(6, 0, 0))}));
  EXPECT_EQ(survey_components(prepared, 0.002, 0, RunContext{}).classes.size(), 3U);
}

TEST(SurveyComponents, RoundPartsAlignWhateverTheirTurn) {
  const Mesh part = test::prism(7, 0.4, 1);
  const Motion turned = Motion::rotation({0, 0, 1}, 0.31, {0, 0, 0});
  const PreparedMesh prepared =
      prepare(test::joined({part, recut(test::moved(test::moved(part, turned), test::shift(2, 1, 0.5)))}));
  const ComponentSurvey survey = survey_components(prepared, 0.002, 0, RunContext{});
  ASSERT_EQ(survey.classes.size(), 1U);
  expect_carried(prepared, survey);
}

// The second is as long as the first to the tolerance, and the third to both; it is the first that it is a copy of.
TEST(SurveyComponents, CopiesAreOfWhatTheyAreMostLike) {
  const Mesh longest = test::box(1.21, 0.31, 0.31);
  const Mesh shorter = test::box(1.17, 0.31, 0.31);
  const Mesh between = test::box(1.2, 0.3, 0.3);
  const PreparedMesh prepared = prepare(
      test::joined({longest, test::moved(shorter, test::shift(0, 4, 0)), test::moved(between, test::shift(0, 8, 0))}));
  const ComponentSurvey survey = survey_components(prepared, 0.00195, 0, RunContext{});
  ASSERT_EQ(survey.classes.size(), 2U);
  EXPECT_EQ(survey.classes.front().members, (std::vector<int>{0, 2}));
}

}  // namespace
}  // namespace orbifit
