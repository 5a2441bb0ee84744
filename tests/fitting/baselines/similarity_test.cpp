#include <gtest/gtest.h>

#include "orbifit/baselines/similarity_fit.h"
#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/model/errors.h"

namespace orbifit {
namespace {

class SimilarityFit : public testing::Test {
 protected:
  SimilarityFit() : model_(generate("chair")) {
    truth_.scale = 1.1;
    truth_.linear = axis_rotation(Eigen::Vector3d(1, 2, 3).normalized(), 0.1);
    truth_.translation = Eigen::Vector3d(0.02, -0.01, 0.03);
  }

  // Of the vertices from where they belong, fraction of the diagonal.
  double error_of(const FitResult& result) const {
    double worst = 0;
    for (Eigen::Index v = 0; v < model_.mesh.vertices.rows(); ++v) {
      const Eigen::Vector3d expected = truth_(model_.mesh.vertices.row(v));
      worst = std::max(worst, (result.fitted.vertices.row(v).transpose() - expected).norm());
    }
    return worst / diagonal(result.fitted.vertices);
  }

  GeneratedModel model_;
  Similarity truth_;
  RunContext context_;
};

TEST_F(SimilarityFit, FindsTheSimilarityOfAScan) {
  Mesh moved = model_.mesh;
  for (Eigen::Index v = 0; v < moved.vertices.rows(); ++v) {
    moved.vertices.row(v) = truth_(model_.mesh.vertices.row(v)).transpose();
  }
  const PointCloud scan = virtual_scan(moved, {}, context_);
  const FitResult result = fit_similarity({model_.mesh, model_.truth, scan, Similarity{}, {}, {}}, {}, context_);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.degrees_of_freedom, 7);
  EXPECT_LT(error_of(result), 2e-3);
}

TEST_F(SimilarityFit, FollowsHandlesExactlyWhereTheyAllow) {
  // Three handles that shrink nothing: a motion alone, since a handle's own motion keeps its scale.
  truth_.scale = 1;
  std::vector<Handle> handles;
  for (const int vertex : {0, 100, 200, 300}) {
    handles.push_back({"", {vertex}, {truth_.linear, truth_.translation}});
  }
  const FitResult result =
      fit_similarity({model_.mesh, model_.truth, PointCloud{}, Similarity{}, {}, handles}, {}, context_);
  EXPECT_LT(error_of(result), 1e-12);
  EXPECT_LT(result.landmark_rms, 1e-12);
}

TEST_F(SimilarityFit, RefusesWhatSaysNothing) {
  EXPECT_THROW(fit_similarity({model_.mesh, model_.truth, PointCloud{}, Similarity{}, {}, {}}, {}, context_),
               InputError);
}

}  // namespace
}  // namespace orbifit
