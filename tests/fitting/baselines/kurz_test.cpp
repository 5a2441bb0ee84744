#include "orbifit/baselines/kurz.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/model/errors.h"

namespace orbifit {
namespace {

KurzOptions coarse() {
  KurzOptions options;
  options.spacing = 0.25;
  options.quadrature_points = 500;
  return options;
}

// Without the symmetries of parts.
SymmetryAnnotation whole_alone(const GeneratedModel& model) {
  SymmetryAnnotation result = model.truth;
  result.patterns.clear();
  std::erase_if(result.regions, [&](const Region& region) {
    return static_cast<Eigen::Index>(region.faces.size()) != model.mesh.faces.rows();
  });
  return result;
}

// A table held at its feet, of which one place of the top is lifted.
class KurzWithHandles : public testing::Test {
 protected:
  KurzWithHandles() : model_(generate("table")), annotation_(whole_alone(model_)) {
    options_ = coarse();
    options_.mode = GroupMode::fixed;
    options_.thin_plate_weight = 1;
  }

  int nearest(const Eigen::Vector3d& place) const {
    Eigen::Index vertex = 0;
    (model_.mesh.vertices.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&vertex);
    return static_cast<int>(vertex);
  }

  std::vector<Handle> handles() const {
    const Eigen::Vector3d high = model_.mesh.vertices.colwise().maxCoeff();
    const Eigen::Vector3d low = model_.mesh.vertices.colwise().minCoeff();
    std::vector<Handle> result;
    for (const double x : {-1.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) {
        result.push_back({"foot", {nearest({x * high.x(), y * high.y(), low.z()})}, {}});
      }
    }
    result.push_back({"top", {nearest({0.6 * high.x(), 0.3 * high.y(), high.z()})}, {}});
    result.back().motion.translation = {0.05, 0.02, 0.2};
    return result;
  }

  // The handles and their images under the group.
  std::vector<Handle> symmetric_handles() const {
    std::vector<Handle> result;
    for (const Handle& handle : handles()) {
      for (const Motion& element : annotation_.regions.front().elements) {
        const Eigen::Vector3d place = element(model_.mesh.vertices.row(handle.vertices.front()));
        const int vertex = nearest(place);
        EXPECT_LT((model_.mesh.vertices.row(vertex).transpose() - place).norm(), 1e-9);
        result.push_back({handle.name, {vertex}, {}});
        result.back().motion.translation = element.linear * handle.motion.translation;
      }
    }
    return result;
  }

  // For a symmetric deformation a handle is as far from its target as its images from theirs, and the energy without
  // symmetry terms is itself symmetric: its least is reached by a symmetric one.
  Points symmetric_edit() const {
    KurzOptions plain = options_;
    plain.symmetry_weight = 0;
    plain.handle_weight /= static_cast<double>(annotation_.regions.front().elements.size());
    return edited(symmetric_handles(), plain).fitted.vertices;
  }

  FitResult edited(const std::vector<Handle>& handles, const KurzOptions& options) const {
    return fit_kurz({model_.mesh, annotation_, nothing_, Similarity{}, {}, handles}, options, {});
  }

  FitResult edited_with(double weight) const {
    KurzOptions options = options_;
    options.symmetry_weight = weight;
    options.condition = true;
    return edited(handles(), options);
  }

  GeneratedModel model_;
  SymmetryAnnotation annotation_;
  PointCloud nothing_;
  KurzOptions options_;
};

TEST_F(KurzWithHandles, TendsToTheSymmetricEditLikeOneByItsWeightUntilRoundingStopsIt) {
  ASSERT_EQ(annotation_.regions.size(), 1U);
  const Points exact = symmetric_edit();
  std::vector<double> errors;
  std::vector<FitResult> results;
  for (const double weight : {1e4, 1e5, 1e6, 1e7, 1e11}) {
    results.push_back(edited_with(weight));
    errors.push_back((results.back().fitted.vertices - exact).rowwise().norm().maxCoeff());
  }
  for (std::size_t i = 0; i + 1 < 4; ++i) {
    EXPECT_NEAR(errors[i] / errors[i + 1], 10, 2) << i;
    EXPECT_NEAR(results[i].field_residual / results[i + 1].field_residual, 10, 1.5) << i;
    EXPECT_NEAR(results[i + 1].condition / results[i].condition, 10, 1) << i;
  }
  // What the symmetry leaves open is then lost in the rounding of its weight, though the symmetry itself is kept.
  EXPECT_GT(results[4].condition, 1e17);
  EXPECT_GT(errors[4], 100 * errors[3]);
  EXPECT_LT(results[4].field_residual, results[3].field_residual);
}

TEST_F(KurzWithHandles, WithoutSymmetryAndOverwhelmingWeightReachTheirTargets) {
  options_.symmetry_weight = 0;
  options_.handle_weight = 1e6;
  const FitResult result = edited(handles(), options_);
  EXPECT_LT(result.landmark_rms, 1e-5);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.field_residual, 0);
}

TEST_F(KurzWithHandles, EditIsTheSameInAnotherPoseAndUnit) {
  const Similarity motion{20, axis_rotation(Eigen::Vector3d(1, 2, 3).normalized(), 0.7), {5, -6, 7}};
  const Points here = edited_with(3).fitted.vertices;
  const Points there =
      fit_kurz({model_.mesh, annotation_, nothing_, motion, {}, handles()}, options_, {}).fitted.vertices;
  for (Eigen::Index v = 0; v < here.rows(); ++v) {
    EXPECT_LT((motion(here.row(v).transpose()) - there.row(v).transpose()).norm(), 1e-9);
  }
}

TEST_F(KurzWithHandles, AnnotationHasTheSymmetriesAsTheyWereCarried) {
  const Similarity pose{20, axis_rotation(Eigen::Vector3d(1, 2, 3).normalized(), 0.7), {5, -6, 7}};
  options_.symmetry_weight = 1e6;
  for (const GroupMode mode : {GroupMode::fixed, GroupMode::floating, GroupMode::moving}) {
    options_.mode = mode;
    const FitResult result = fit_kurz({model_.mesh, annotation_, nothing_, pose, {}, handles()}, options_, {});
    RunContext context;
    const SymmetryReport report =
        symmetry_residual(result.fitted, result.annotation, nullptr, CarriedMotions::fixed, context);
    EXPECT_LT(report.worst_floor, 1e-5) << to_string(mode);
    EXPECT_LT(result.field_residual, 1e-6) << to_string(mode);
  }
}

class KurzOfScan : public testing::Test {
 protected:
  KurzOfScan() : template_(generate("table")), truth_(generate("table", {{"width", 1.0}, {"height", 0.78}})) {
    scan_ = virtual_scan(truth_.mesh, {}, context_);
  }

  FitResult fitted(const KurzOptions& options) const {
    return fit_kurz({template_.mesh, template_.truth, scan_, Similarity{}, {}, {}}, options, context_);
  }

  RunContext context_;
  GeneratedModel template_, truth_;
  PointCloud scan_;
};

TEST_F(KurzOfScan, ExplainsItAndEndsAtRest) {
  KurzOptions options = coarse();
  options.smooth_iterations = 0;
  const FitResult result = fitted(options);
  EXPECT_TRUE(result.converged);
  EXPECT_GT(result.inlier_ratio, 0.95);
  EXPECT_EQ(result.stopped_because.substr(0, 9), "converged") << result.stopped_because;
  EXPECT_EQ(result.iterations_in_all, static_cast<int>(result.iterations.size()));
  EXPECT_EQ(result.annotation.regions.size(), template_.truth.regions.size());
}

// Where the functions can follow all symmetries: those of parts that are not aligned with the grid, they cannot.
TEST_F(KurzOfScan, SymmetryErrorFallsLikeOneByItsWeight) {
  KurzOptions options = coarse();
  options.smooth_iterations = 0;
  options.mode = GroupMode::floating;
  template_.truth = whole_alone(template_);
  std::vector<double> errors;
  for (const double weight : {3e3, 3e4, 3e5}) {
    options.symmetry_weight = weight;
    errors.push_back(fitted(options).field_residual);
  }
  EXPECT_NEAR(errors[0] / errors[1], 10, 0.6);
  EXPECT_NEAR(errors[1] / errors[2], 10, 0.1);
}

TEST_F(KurzOfScan, SymmetriesThatMayNotBeCarriedHinderIt) {
  KurzOptions options = coarse();
  options.smooth_iterations = 0;
  options.symmetry_weight = 1000;
  const double moving = fitted(options).inlier_ratio;
  options.mode = GroupMode::floating;
  const double floating = fitted(options).inlier_ratio;
  options.mode = GroupMode::fixed;
  const double fixed = fitted(options).inlier_ratio;
  EXPECT_GT(moving, 0.95);
  EXPECT_GT(floating, 0.95);
  EXPECT_LT(fixed, 0.8);
}

TEST_F(KurzOfScan, IsTheSameWithTwoThreads) {
  KurzOptions options = coarse();
  options.linear_iterations = 3;
  const FitResult one = fitted(options);
  context_.threads = 2;
  EXPECT_EQ(fitted(options).fitted.vertices, one.fitted.vertices);
}

TEST_F(KurzOfScan, OfTheTemplateItselfLeavesIt) {
  KurzOptions options = coarse();
  options.smooth_iterations = 0;
  ScanOptions all_around;
  all_around.views = 3;
  scan_ = virtual_scan(template_.mesh, all_around, context_);
  const FitResult result = fitted(options);
  const double worst = (result.fitted.vertices - template_.mesh.vertices).rowwise().norm().maxCoeff();
  EXPECT_LT(worst, 0.01 * diagonal(template_.mesh.vertices));
}

TEST_F(KurzOfScan, RefusesWhatMakesNoSense) {
  scan_ = {};
  EXPECT_THROW(fitted({}), InputError);
  KurzOptions options;
  options.thin_plate_weight = 0;
  EXPECT_THROW(fitted(options), UsageError);
  options = {};
  options.spacing = 2;
  EXPECT_THROW(options.validate(), UsageError);
}

}  // namespace
}  // namespace orbifit
