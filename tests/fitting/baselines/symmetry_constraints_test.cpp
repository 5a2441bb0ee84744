#include "orbifit/baselines/symmetry_constraints.h"

#include <string>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "orbifit/baselines/svd_nullspace.h"
#include "orbifit/datasets_tools/generate.h"

#include "base/dense.h"
#include "basis/subspace_parts.h"
#include "random_pulls.h"

namespace orbifit {
namespace {

using Eigen::MatrixXd;

class Constraints : public testing::TestWithParam<ModelCase> {
 protected:
  static Subspace subspace_of(LiftKind lift) {
    const GeneratedModel model = generate(GetParam().model);
    SubspaceOptions options;
    options.mode = GetParam().mode;
    options.lift = lift;
    options.samples = 120;
    return build_subspace(model.mesh, model.truth, options, RunContext{});
  }
};

TEST_P(Constraints, HoldForTheBasis) {
  for (const LiftKind lift : {LiftKind::paper, LiftKind::orbit}) {
    const Subspace subspace = subspace_of(lift);
    const Eigen::SparseMatrix<double> constraints = symmetry_constraints(subspace);
    ASSERT_GT(constraints.rows(), 0);
    MatrixXd basis(constraints.cols(), subspace.degrees_of_freedom());
    basis << MatrixXd(subspace->basis.columns), subspace->basis.carried;
    EXPECT_LT((constraints * basis).cwiseAbs().maxCoeff(), 1e-12);
  }
}

// Cosines of the principal angles between the displacements of the samples that both bases span.
TEST_P(Constraints, NullSpaceIsThatOfTheBasis) {
  const Subspace subspace = subspace_of(LiftKind::paper);
  const Subspace dense = with_svd_basis(subspace);
  ASSERT_EQ(dense.degrees_of_freedom(), subspace.degrees_of_freedom());
  const auto orthonormal = [](const Subspace& each) -> MatrixXd {
    const Eigen::HouseholderQR<MatrixXd> qr(MatrixXd(each->basis.columns));
    return qr.householderQ() * MatrixXd::Identity(each->basis.columns.rows(), each.degrees_of_freedom());
  };
  const MatrixXd cosines = orthonormal(subspace).transpose() * orthonormal(dense);
  EXPECT_GT(Eigen::JacobiSVD<MatrixXd>(cosines).singularValues().minCoeff(), 1 - 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Models, Constraints,
                         testing::Values(ModelCase{"bar", GroupMode::fixed}, ModelCase{"bar", GroupMode::floating},
                                         ModelCase{"table", GroupMode::fixed}, ModelCase{"table", GroupMode::floating},
                                         ModelCase{"chair", GroupMode::floating}, ModelCase{"fan", GroupMode::floating},
                                         ModelCase{"armchair", GroupMode::fixed}));

}  // namespace
}  // namespace orbifit
