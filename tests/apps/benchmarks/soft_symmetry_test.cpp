#include "soft_symmetry.h"

#include <ostream>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "basis/subspace_parts.h"
#include "subject.h"

namespace orbifit::benchmarks {
namespace {

struct SoftCase {
  const char* model;
  GroupMode mode;
  int samples;
};

std::ostream& operator<<(std::ostream& out, const SoftCase& each) {
  return out << each.model << " " << to_string(each.mode);
}

class SoftSymmetryOn : public testing::TestWithParam<SoftCase> {
 protected:
  SoftSymmetryOn() : model_(benchmark_model(GetParam().model)) {
    SubspaceOptions options;
    options.mode = GetParam().mode;
    options.samples = GetParam().samples;
    subspace_ = build_subspace(model_.mesh, model_.annotation, options, context_);
    handles_ = handle_rows(model_, subspace_, context_);
    // Pulled aside, so that the symmetry has something to hold.
    handles_.targets.rowwise() += 0.02 * diagonal(model_.mesh.vertices) * Eigen::RowVector3d(1, 2, 0.5);
  }

  // The minimum of the same energy among the displacements that are symmetric exactly: u = U q.
  Points constrained(int iterations) const {
    const Corotation laplace = corotation(subspace_->sampling.points, 2 * subspace_->sampling.radius);
    const Eigen::MatrixXd u = subspace_->basis.columns;
    const Eigen::MatrixXd weighted = handles_.weights.asDiagonal() * Eigen::MatrixXd(handles_.rows);
    const Eigen::MatrixXd scalar = Eigen::MatrixXd(laplace.laplacian.transpose() * laplace.laplacian) +
                                   kAlpha * handles_.rows.transpose() * weighted;
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(u.rows(), u.rows());
    for (Eigen::Index i = 0; i < scalar.rows(); ++i) {
      for (Eigen::Index j = 0; j < scalar.cols(); ++j) {
        system.block<3, 3>(3 * i, 3 * j) = scalar(i, j) * Eigen::Matrix3d::Identity();
      }
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(u.transpose() * system * u);
    std::vector<Eigen::Matrix3d> rotations(laplace.neighbours.size(), Eigen::Matrix3d::Identity());
    Points displacements;
    for (int i = 0; i < iterations; ++i) {
      const Points pull = corotated_pull(laplace, rotations) + kAlpha * weighted.transpose() * handles_.targets;
      const Eigen::VectorXd all = u * factor.solve(u.transpose() * stacked(pull));
      displacements = Eigen::Map<const Points>(all.data(), laplace.rest.rows(), 3);
      rotations = local_rotations(laplace, laplace.rest + displacements, rotations);
    }
    return displacements;
  }

  RunContext context_;
  BenchmarkModel model_;
  Subspace subspace_;
  HandleRows handles_;
};

TEST_P(SoftSymmetryOn, ApproachesTheSubspaceAsItsWeightGrows) {
  const double size = diagonal(model_.mesh.vertices);
  const Points exact = constrained(kIterations);
  ASSERT_GT(exact.rowwise().norm().maxCoeff(), 1e-3 * size);
  std::vector<double> residuals;
  std::vector<double> distances;
  for (const double weight : {1e-2, 1e2, 1e4, 1e6}) {
    SoftSymmetry soft(soft_sampling(subspace_), weight);
    soft.set_handles(handles_.rows, handles_.weights, kAlpha);
    const Points displacements = soft.solve(handles_.targets, kIterations);
    distances.push_back((displacements - exact).rowwise().norm().maxCoeff() / size);
    residuals.push_back(soft.symmetry_residual() / size);
  }
  EXPECT_GT(residuals.front(), 1e-3);
  EXPECT_GT(distances.front(), 1e-3);
  // What a penalty leaves is in inverse proportion to its weight.
  for (std::size_t i = 2; i < residuals.size(); ++i) {
    EXPECT_LT(residuals[i], 0.1 * residuals[i - 1]);
    EXPECT_LT(distances[i], 0.2 * distances[i - 1]);
  }
  EXPECT_LT(residuals.back(), 3e-5);
  EXPECT_LT(distances.back(), 3e-5);
}

INSTANTIATE_TEST_SUITE_P(Models, SoftSymmetryOn,
                         testing::Values(SoftCase{"bar", GroupMode::fixed, 100},
                                         SoftCase{"bar", GroupMode::floating, 100},
                                         SoftCase{"fan", GroupMode::fixed, 150},
                                         SoftCase{"chair", GroupMode::floating, 150}));

}  // namespace
}  // namespace orbifit::benchmarks
