#include "kurz_terms.h"

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

#include "base/random.h"
#include "geometry/sampling.h"
#include "kurz_ceres.h"
#include "kurz_normal.h"
#include "thin_plate.h"

namespace orbifit {
namespace {

struct TermsCase {
  const char* name;
  const char* model;
  GridBasis basis;
  double spacing;  // of the diagonal
};

Points normal_points(Eigen::Index rows, double scale, Random& random) {
  return Points::NullaryExpr(rows, 3, [&] { return scale * random.normal(); });
}

// A template with random pulls and data, its symmetries turned at random.
class Terms : public testing::TestWithParam<TermsCase> {
 protected:
  Terms()
      : model_(generate(GetParam().model)),
        size_(diagonal(model_.mesh.vertices)),
        terms_(kurz_terms(grid_around(model_.mesh.vertices, GetParam().spacing * size_, GetParam().basis),
                          symmetry_demands(model_.mesh, model_.truth, 64, GroupMode::moving, {}))),
        plate_(thin_plate(terms_.grid)),
        state_(rest_state(terms_, model_.truth.regions.size())) {
    terms_.thin_plate = 0.7;
    terms_.symmetry_weight = 90;
    terms_.hold = 0.01;
    const Points pulled = sample_surface(model_.mesh, 20, random_).points;
    terms_.pulls = {basis_values(terms_.grid, pulled), normal_points(20, 0.1 * size_, random_),
                    Eigen::VectorXd::Constant(20, 1.5)};
    const SurfaceSamples seen = sample_surface(model_.mesh, 300, random_);
    data_ = {basis_values(terms_.grid, seen.points), normal_points(300, 0.1 * size_, random_), seen.normals,
             Eigen::VectorXd::LinSpaced(300, 0.1, 2)};
    state_.nodes = normal_points(state_.nodes.rows(), 0.05 * size_, random_);
    for (Eigen::Matrix3d& rotation : state_.rotations) rotation = axis_rotation(random_.direction(), 0.2);
  }

  double energy(const KurzState& state) const {
    return kurz_energy(terms_, plate_, data_, state).sum() +
           terms_.hold *
               ((state.nodes - state_.nodes).squaredNorm() + (state.carriers - state_.carriers).squaredNorm());
  }

  KurzState solved() const {
    KurzState state = state_;
    KurzNormal(terms_, plate_).solve(data_, state);
    return state;
  }

  // The motion y -> R y + t of the whole deformed shape, which carries every group.
  KurzState moved_rigidly(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift) const {
    KurzState state = state_;
    state.nodes = affine_coefficients(terms_.grid, rotation - Eigen::Matrix3d::Identity(), shift);
    state.rotations.assign(state.rotations.size(), rotation);
    for (std::size_t r = 0; r < state.rotations.size(); ++r) {
      const Eigen::Vector3d& centre = model_.truth.regions[r].centre;
      state.carriers.row(terms_.symmetry.carrier_of_region[r]) = (rotation * centre + shift - centre).transpose();
    }
    return state;
  }

  double worst_difference(const KurzState& state) const {
    double worst = 0;
    for (std::size_t d = 0; d < terms_.symmetry.demands.size(); ++d) {
      if (terms_.symmetry.demands[d].region < 0) continue;
      worst = std::max(worst, symmetry_differences(terms_, d, state).cwiseAbs().maxCoeff());
    }
    return worst / size_;
  }

  Random random_{4};
  GeneratedModel model_;
  double size_;
  KurzTerms terms_;
  Eigen::SparseMatrix<double> plate_;
  KurzState state_;
  DataTerm data_;
};

TEST_P(Terms, NormalEquationsFindTheLeastEnergy) {
  const KurzState least = solved();
  const double value = energy(least);
  for (int k = 0; k < 10; ++k) {
    const Points nodes = normal_points(least.nodes.rows(), 1e-3 * size_, random_);
    const Points carriers = k % 2 == 0 ? normal_points(least.carriers.rows(), 1e-3 * size_, random_)
                                       : Points(Points::Zero(least.carriers.rows(), 3));
    KurzState there = least;
    KurzState back = least;
    there.nodes += nodes;
    there.carriers += carriers;
    back.nodes -= nodes;
    back.carriers -= carriers;
    const double curvature = energy(there) + energy(back) - 2 * value;
    EXPECT_GT(curvature, 0);
    EXPECT_LT(std::abs(energy(there) - energy(back)), 1e-7 * curvature + 1e-10 * value);
  }
}

TEST_P(Terms, CeresFindsTheSame) {
  const KurzState least = solved();
  KurzState other = state_;
  solve_with_ceres(terms_, data_, other);
  EXPECT_LT((other.nodes - least.nodes).norm(), 1e-8 * least.nodes.norm());
}

TEST_P(Terms, AreTheSameSolvedAgain) {
  KurzNormal normal(terms_, plate_);
  KurzState first = state_;
  normal.solve(data_, first);
  KurzState second = state_;
  normal.solve(data_, second);
  EXPECT_EQ(first.nodes, second.nodes);
}

TEST_P(Terms, SymmetryIsKeptByRestAndByRigidMotionsThatCarryIt) {
  EXPECT_LT(worst_difference(moved_rigidly(Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero())), 1e-12);
  EXPECT_LT(worst_difference(moved_rigidly(Eigen::Matrix3d::Identity(), {0.1, -0.2, 0.3})), 1e-12);
  EXPECT_LT(worst_difference(moved_rigidly(axis_rotation(random_.direction(), 0.4), {0.1, -0.2, 0.3})), 1e-12);
}

TEST_P(Terms, TurnsOfTheSymmetriesFollowTheShape) {
  KurzState state = moved_rigidly(axis_rotation(random_.direction(), 0.4), {0.1, -0.2, 0.3});
  state.rotations.assign(state.rotations.size(), Eigen::Matrix3d::Identity());
  EXPECT_GT(worst_difference(state), 1e-2);
  for (int i = 0; i < 10; ++i) turn_symmetries(terms_, state);
  EXPECT_LT(worst_difference(state), 1e-9);
}

TEST_P(Terms, ConditionIsThatOfTheMatrix) {
  KurzNormal normal(terms_, plate_);
  KurzState state = state_;
  normal.solve(data_, state);
  const double before = normal.condition();
  EXPECT_GT(before, 1);
  terms_.symmetry_weight *= 1e4;
  KurzNormal stiff(terms_, plate_);
  stiff.solve(data_, state);
  EXPECT_GT(stiff.condition(), 100 * before);
}

INSTANTIATE_TEST_SUITE_P(Models, Terms,
                         testing::Values(TermsCase{"table_linear", "table", GridBasis::linear, 0.25},
                                         TermsCase{"bar_cubic", "bar", GridBasis::cubic, 1},
                                         TermsCase{"chair_linear", "chair", GridBasis::linear, 0.25}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace orbifit
