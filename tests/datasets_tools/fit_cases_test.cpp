#include "cases/fit_cases.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace orbifit {
namespace {

class CaseOf : public testing::TestWithParam<FitLevel> {};

TEST_P(CaseOf, TruthIsThePosedShapeAndTheScanLiesOnIt) {
  RunContext context;
  const FitFamily& family = fit_families().front();
  const FitCase each = fit_case(family, GetParam(), context);
  EXPECT_EQ(each.truth.faces, each.model.mesh.faces);
  const double size = diagonal(each.truth.vertices);
  const double own = diagonal(generate(family.name, family.parameters).mesh.vertices);
  EXPECT_EQ(GetParam() == FitLevel::anywhere, std::abs(each.pose.scale - 1) > 1e-9);
  EXPECT_NEAR(each.pose.scale * own, size, 0.75 * size) << "a turned box has another diagonal";
  EXPECT_GT(std::ranges::count(each.visible, 1), 100);
  EXPECT_GT(std::ranges::count(each.visible, 0), 100);
  // Where the truth is the fit there is no error, and the template where it was put is off.
  const FitScore perfect = score_fit(each, each.truth, context);
  EXPECT_LT(perfect.visible, 1e-9);
  EXPECT_LT(perfect.hidden, 1e-9);
  EXPECT_LT(perfect.correspondence.value(), 1e-9);
  EXPECT_NEAR(perfect.f_score, 1, 1e-12);
  Mesh posed = each.model.mesh;
  for (Eigen::Index v = 0; v < posed.vertices.rows(); ++v) {
    posed.vertices.row(v) = each.pose(posed.vertices.row(v).transpose()).transpose();
  }
  const FitScore before = score_fit(each, posed, context);
  EXPECT_GT(before.visible, 0.003);
  EXPECT_GT(before.hidden, 0.003);
  EXPECT_LT(before.f_score, 0.97);
}

TEST_P(CaseOf, ASymmetricCopyIsAsGood) {
  RunContext context;
  const FitCase each = fit_case({"table", {{"width", 1.1}}}, GetParam(), context);
  const Region& whole = *std::ranges::max_element(each.model.truth.regions, {},
                                                  [](const Region& region) { return region.elements.size(); });
  ASSERT_GT(whole.elements.size(), 4U);
  Mesh turned = each.truth;
  const Motion there = conjugate(each.pose, whole.elements[1]);
  for (Eigen::Index v = 0; v < turned.vertices.rows(); ++v) {
    turned.vertices.row(v) = there(turned.vertices.row(v).transpose()).transpose();
  }
  EXPECT_GT((turned.vertices - each.truth.vertices).norm(), 0.1 * diagonal(each.truth.vertices));
  EXPECT_LT(score_fit(each, turned, context).correspondence.value(), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Levels, CaseOf,
                         testing::Values(FitLevel::three_views, FitLevel::one_view, FitLevel::anywhere,
                                         FitLevel::other_shape, FitLevel::several));

TEST(FitCases, AShapeIsChangedFurther) {
  RunContext context;
  const ShapeChange wider = [](const GeneratedModel& model, RunContext&) -> Points { return 2 * model.mesh.vertices; };
  const FitCase each = fit_case(fit_families().front(), FitLevel::other_shape, context, wider);
  const Mesh family = generate(each.name, fit_families().front().parameters).mesh;
  EXPECT_EQ(each.truth.vertices, 2 * family.vertices);
  EXPECT_NEAR(diagonal(each.scan.points), diagonal(each.truth.vertices), 0.05 * diagonal(each.truth.vertices));
}

TEST(FitCases, SeveralScansSeeMoreThanOne) {
  RunContext context;
  const FitCase several = fit_case(fit_families().front(), FitLevel::several, context);
  const FitCase one = fit_case(fit_families().front(), FitLevel::one_view, context);
  EXPECT_EQ(several.others.size(), 2U);
  EXPECT_GT(std::ranges::count(several.visible, 1), std::ranges::count(one.visible, 1));
  for (const PointCloud& scan : several.others) {
    EXPECT_GT((scan.points.colwise().mean() - several.scan.points.colwise().mean()).norm(),
              0.1 * diagonal(several.truth.vertices));
  }
}

TEST(FitCases, EveryFamilyKeepsItsConnectivity) {
  EXPECT_GE(fit_families().size(), 8U);
  for (const FitFamily& family : fit_families()) {
    const Mesh shape = generate(family.name, family.parameters).mesh;
    const Mesh rest = generate(family.name).mesh;
    EXPECT_EQ(shape.faces, rest.faces) << family.name;
    EXPECT_GT((shape.vertices - rest.vertices).rowwise().norm().maxCoeff(), 0.02 * diagonal(rest.vertices))
        << family.name;
  }
}

}  // namespace
}  // namespace orbifit
