#include "comparison.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/model/errors.h"

#include "comparison_report.h"
#include "divided.h"

namespace orbifit {
namespace {

TEST(Divided, IsTheSameSurfaceWithTheSameSymmetries) {
  RunContext context;
  const GeneratedModel model = generate("bar");
  const AnnotatedMesh finer = divided(model.mesh, model.truth);
  EXPECT_EQ(finer.mesh.faces.rows(), 4 * model.mesh.faces.rows());
  EXPECT_EQ(finer.mesh.vertices.topRows(model.mesh.vertices.rows()), model.mesh.vertices);
  EXPECT_NEAR(face_areas(finer.mesh).sum(), face_areas(model.mesh).sum(), 1e-12);
  const Eigen::VectorXd areas = face_areas(finer.mesh);
  for (Eigen::Index f = 0; f < model.mesh.faces.rows(); ++f) {
    ASSERT_NEAR(areas.segment(4 * f, 4).sum(), face_areas(model.mesh)[f], 1e-12);
    ASSERT_GT(face_normal(finer.mesh, 4 * f + 3).dot(face_normal(model.mesh, f)), 0.999);
  }
  const SymmetryReport report =
      symmetry_residual(finer.mesh, finer.annotation, nullptr, CarriedMotions::fixed, context);
  EXPECT_LT(report.worst_floor, 1e-9);
}

class EachMethod : public testing::TestWithParam<std::string> {
 protected:
  static const Method& method() { return *std::ranges::find(methods(), GetParam(), &Method::name); }

  RunContext context_;
  GeneratedModel model_ = generate("table");
};

TEST_P(EachMethod, FitsAScanAndSaysWhatItTook) {
  const GeneratedModel truth = generate("table", {{"width", 1.0}});
  const PointCloud scan = virtual_scan(truth.mesh, {}, context_);
  const ComparisonTruth known{truth.mesh, visible_vertices(truth.mesh, scan.points)};
  FitOptions options = with_few_iterations({});
  options.align = false;
  options.subspace.samples = 80;
  const MethodRun run =
      run_method(method(), method().weight, {model_.mesh, model_.truth, scan, Similarity{}}, options, &known, context_);
  ASSERT_EQ(run.failure, "");
  EXPECT_EQ(run.result.fitted.faces, model_.mesh.faces);
  EXPECT_EQ(run.vertex_excess.size(), model_.mesh.vertices.rows());
  EXPECT_DOUBLE_EQ(run.vertex_excess.maxCoeff(), run.symmetry);
  ASSERT_TRUE(run.score && run.score->correspondence);
  EXPECT_GT(run.result.degrees_of_freedom, 5);
  if (GetParam() != "similarity") {
    EXPECT_GT(run.iteration, 0);
    EXPECT_LT(run.score->visible, 0.02);
  }
  const bool keeps = GetParam() == "ours" || GetParam() == "similarity";
  EXPECT_EQ(run.symmetry < 1e-9, keeps) << run.symmetry;
}

TEST_P(EachMethod, EditsByHandlesAlone) {
  const PointCloud none;
  FitInput input{model_.mesh, model_.truth, none, Similarity{}};
  Handle handle;
  for (int v = 0; v < 40; ++v) handle.vertices.push_back(v);
  handle.motion.translation = {0, 0, 0.02};
  input.handles = {handle};
  FitOptions options = with_few_iterations({});
  options.subspace.samples = 80;
  const MethodRun run = run_method(method(), method().weight, input, options, nullptr, context_);
  ASSERT_EQ(run.failure, "");
  EXPECT_LT(run.result.landmark_rms, 0.5 * 0.02 / diagonal(model_.mesh.vertices));
  EXPECT_FALSE(run.score);
}

INSTANTIATE_TEST_SUITE_P(Methods, EachMethod,
                         testing::Values("ours", "kurz", "soft", "full-constrained", "svd-nullspace", "none",
                                         "similarity"),
                         [](const auto& each) {
                           std::string name = each.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(Compare, RefusesAMethodThatThereIsNot) {
  ComparisonOptions options;
  options.methods = {"magic"};
  EXPECT_THROW(options.validate(), UsageError);
  options = {};
  options.weights = {0};
  EXPECT_THROW(options.validate(), UsageError);
}

TEST(Compare, TellsTheSameAsTextCsvAndJson) {
  RunContext context;
  const GeneratedModel model = generate("table");
  const PointCloud scan = virtual_scan(model.mesh, {}, context);
  ComparisonOptions options;
  options.methods = {"ours", "soft"};
  options.weights = {1, 100};
  options.samples = {60};
  options.meshes = 1;
  options.fit = with_few_iterations({});
  options.fit.subspace.samples = 60;
  const Comparison comparison = compare({model.mesh, model.truth, scan, Similarity{}}, options, nullptr, context);
  const auto json = nlohmann::json::parse(comparison_json(comparison));
  ASSERT_EQ(json["methods"].size(), 2U);
  EXPECT_EQ(json["methods"][0]["method"], "ours");
  EXPECT_TRUE(json["methods"][0]["hidden"].is_null());
  EXPECT_EQ(json["weights"].size(), 2U);
  EXPECT_EQ(json["samples"].size(), 2U);
  EXPECT_EQ(json["meshes"].size(), 2U);
  // A weightier penalty leaves less of the asymmetry.
  EXPECT_LT(json["weights"][1]["symmetry_residual"], json["weights"][0]["symmetry_residual"]);
  const std::string csv = comparison_csv(comparison);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 3);
  EXPECT_NE(comparison_text(comparison).find("soft"), std::string::npos);
  const std::string page = comparison_html(comparison, scan, Eigen::Vector3d::UnitZ(), context);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("://"), std::string::npos);
}

}  // namespace
}  // namespace orbifit
