#include <cmath>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "resolution/transfer.h"

namespace orbifit {
namespace {

struct Transfer {
  const char* model;
  GroupMode mode;

  friend void PrintTo(const Transfer& each, std::ostream* out) { *out << each.model << "_" << to_string(each.mode); }
};

class FinerSubspace : public testing::TestWithParam<Transfer> {};

TEST_P(FinerSubspace, ContainsTheCoarseDisplacements) {
  const RunContext context;
  const GeneratedModel model = generate(GetParam().model, {{"detail", 1}});
  SubspaceOptions options;
  options.mode = GetParam().mode;
  options.radius = 0.09 * diagonal(model.mesh.vertices);
  const Subspace coarse = build_subspace(model.mesh, model.truth, options, context);
  options.radius /= std::sqrt(3);
  const Subspace fine = build_subspace(model.mesh, model.truth, options, context);
  ASSERT_GT(fine.degrees_of_freedom(), coarse.degrees_of_freedom());
  SubspaceState state{Eigen::VectorXd(coarse.degrees_of_freedom()), nullptr};
  Random random(4);
  for (double& entry : state.q) entry = 0.05 * diagonal(model.mesh.vertices) * random.uniform(-1, 1);
  const Points expected = displacement_field(coarse, state, fine.samples(), fine->sampling.sets, context);
  const Points found = sample_displacements(fine, transferred(coarse, state, fine, context));
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-10 * expected.cwiseAbs().maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Models, FinerSubspace,
                         testing::Values(Transfer{"table", GroupMode::fixed}, Transfer{"table", GroupMode::floating},
                                         Transfer{"chair", GroupMode::fixed}, Transfer{"chair", GroupMode::floating},
                                         Transfer{"bar", GroupMode::floating},
                                         Transfer{"centre_piece", GroupMode::floating}));

// A chair whose parts differ in more than lengths is fitted more finely than one that differs in nothing.
class Resolution : public testing::Test {
 protected:
  FitResult fitted(const Mesh& truth, double noise, int refinements) {
    ScanOptions scanner;
    scanner.noise = noise;
    scanner.views = 3;
    const PointCloud scan = virtual_scan(truth, scanner, context_);
    FitOptions options;
    options.refinements = refinements;
    return fit({template_.mesh, template_.truth, scan, Similarity{}}, options, context_);
  }

  double error(const FitResult& result, const Mesh& truth) const {
    return (result.fitted.vertices - truth.vertices).rowwise().norm().mean() / diagonal(truth.vertices);
  }

  RunContext context_;
  GeneratedModel template_ = generate("chair");
};

TEST_F(Resolution, IsFinerWhereTheScanShowsMore) {
  // Bumps as fine as a subspace of twice the unknowns has them, as symmetric as the chair.
  Mesh bulged = template_.mesh;
  SubspaceOptions options;
  options.samples = 3000;
  const Subspace subspace = build_subspace(template_.mesh, template_.truth, options, context_);
  Eigen::VectorXd q(subspace.degrees_of_freedom());
  Random random(2);
  for (double& entry : q) entry = 0.006 * diagonal(bulged.vertices) * random.normal();
  bulged.vertices += vertex_displacements(subspace, q);
  const FitResult coarse = fitted(bulged, 0, 0);
  const FitResult fine = fitted(bulged, 0, 2);
  ASSERT_TRUE(fine.converged) << fine.stopped_because;
  ASSERT_GE(fine.levels.size(), 2U);
  EXPECT_TRUE(fine.levels[1].kept);
  EXPECT_GT(fine.degrees_of_freedom, 2 * coarse.degrees_of_freedom);
  EXPECT_EQ(fine.degrees_of_freedom, fine.subspace.degrees_of_freedom());
  for (std::size_t i = 1; i < fine.levels.size(); ++i) {
    EXPECT_FALSE(fine.levels[i].kept && fine.levels[i].held_out >= fine.levels[i].held_out_before) << i;
  }
  EXPECT_LT(fine.rms, coarse.rms);
  EXPECT_LT(error(fine, bulged), error(coarse, bulged));
  EXPECT_LT(fine.field_residual, 1e-12);
}

TEST_F(Resolution, IsNotFinerForNoise) {
  const FitResult result = fitted(template_.mesh, 0.003, 2);
  ASSERT_TRUE(result.converged) << result.stopped_because;
  ASSERT_FALSE(result.levels.empty());
  EXPECT_TRUE(result.levels.front().kept);
  for (std::size_t i = 1; i < result.levels.size(); ++i) EXPECT_FALSE(result.levels[i].kept) << i;
  EXPECT_LT(error(result, template_.mesh), 0.003);
}

TEST_F(Resolution, StaysAsItWasAskedFor) {
  ScanOptions scanner;
  const PointCloud scan = virtual_scan(template_.mesh, scanner, context_);
  FitOptions options;
  options.subspace.samples = 300;
  const FitResult result = fit({template_.mesh, template_.truth, scan, Similarity{}}, options, context_);
  EXPECT_TRUE(result.levels.empty());
  EXPECT_LT(result.samples, 400);
}

}  // namespace
}  // namespace orbifit
