#include "solver/fit_system.h"

#include <cmath>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

#include "random_pulls.h"
#include "registration/alignment.h"

namespace orbifit {
namespace {

struct SystemCase {
  const char* model;
  bool scale_open;

  friend void PrintTo(const SystemCase& each, std::ostream* stream) {
    *stream << each.model << (each.scale_open ? "_of_open_scale" : "");
  }
};

// A template with random points beside its surface, which pull it there.
class System : public testing::TestWithParam<SystemCase> {
 protected:
  System()
      : model_(generate(GetParam().model)),
        subspace_(build_subspace(model_.mesh, model_.truth, {}, context_)),
        system_(subspace_, model_.mesh, 0.3),
        size_(diagonal(model_.mesh.vertices)),
        pivot_(bounding_box_centre(model_.mesh.vertices)),
        data_(model_.mesh, random_) {
    hold_.stiffness = 0.3;
    hold_.damping = 0.2;
    hold_.scale_open = GetParam().scale_open;
    hold_.grown = 0.07;
    hold_.around = Eigen::VectorXd::Zero(subspace_.degrees_of_freedom());
    for (double& value : hold_.around) value = 0.01 * size_ * random_.uniform(-1, 1);
    system_.rotate(hold_.around);
  }

  // The sum that solve() says it minimises; of the pose its unknowns, not yet a motion.
  double energy(const Eigen::VectorXd& x) const {
    const Eigen::Index dof = subspace_.degrees_of_freedom();
    const Eigen::VectorXd q = x.head(dof);
    const Eigen::Vector3d omega = x.segment<3>(x.size() - 6) / size_;
    const double growth = x.size() > dof + 6 ? 1 + x[dof] / size_ : 1;
    const Eigen::RowVector3d pivot = pivot_.transpose();
    const Points grown = (growth * (model_.mesh.vertices.rowwise() - pivot)).rowwise() + pivot;
    const Points moved = grown + vertex_displacements(subspace_, q);
    const auto scan = [&](const Eigen::Vector3d& s) -> Eigen::Vector3d {
      return s + omega.cross(s - pivot_) + x.tail<3>();
    };
    double sum = hold_.stiffness * system_.regularity(q) + hold_.damping * (q - hold_.around).squaredNorm() +
                 hold_.damping * x.tail(x.size() - dof).squaredNorm() +
                 hold_.stiffness * system_.growth_cost(hold_.grown + growth - 1);
    for (const Correspondence& pair : data_.pairs) {
      const Eigen::Vector3d foot = moved(model_.mesh.faces.row(pair.face), Eigen::all).transpose() * pair.barycentric;
      const double offset = pair.normal.dot(foot - scan(data_.points.row(pair.scan_point)));
      sum += kShare * pair.weight * offset * offset;
    }
    for (const Pull& pull : data_.pulls) {
      sum += pull.weight * (moved.row(pull.vertex).transpose() - scan(pull.target)).squaredNorm();
    }
    return sum;
  }

  static constexpr double kShare = 0.4;
  RunContext context_;
  GeneratedModel model_;
  Subspace subspace_;
  FitSystem system_;
  double size_;
  Eigen::Vector3d pivot_;
  Random random_{7};
  RandomPulls data_;
  FitSystem::Hold hold_;
};

TEST_P(System, SolutionIsWhereTheEnergyIsLeast) {
  const FitSystem::Solution solution = system_.solve(data_.pairs, kShare, data_.points, data_.pulls, hold_, context_);
  const Eigen::Index dof = subspace_.degrees_of_freedom();
  const Eigen::Index of_pose = GetParam().scale_open ? 7 : 6;
  Eigen::VectorXd x(dof + of_pose);
  // Back to the unknowns: the growth, and of the motion a rotation vector about the pivot and a translation.
  const AxisAngle turn = axis_angle(solution.scan_step.linear);
  x.tail<6>() << size_ * turn.angle * turn.axis, solution.scan_step(pivot_) - pivot_;
  x.head(dof) = solution.growth * solution.q;
  if (GetParam().scale_open) {
    EXPECT_NE(solution.growth, 1);
    x[dof] = size_ * (solution.growth - 1);
  } else {
    EXPECT_EQ(solution.growth, 1);
  }
  const double least = energy(x);
  Random random(1);
  for (Eigen::Index k = 0; k < 6 + of_pose; ++k) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(x.size());
    if (k < 6) {
      for (double& value : step) value = random.uniform(-1, 1);
    } else {
      step[dof + k - 6] = 1;
    }
    step *= 1e-3 * size_ / step.norm();
    const double forwards = energy(x + step) - least;
    const double backwards = energy(x - step) - least;
    EXPECT_GT(forwards, 0);
    EXPECT_GT(backwards, 0);
    // The slope is what the two differ by. A samples' share of 1e-6 prefers the pose to a deformation.
    EXPECT_LT(std::abs(forwards - backwards), 2e-2 * (forwards + backwards));
  }
}

TEST_P(System, SolutionIsTheSameWithTwoThreads) {
  FitSystem other(subspace_, model_.mesh, 0.3);
  other.rotate(hold_.around);
  RunContext two;
  two.threads = 2;
  const FitSystem::Solution one = system_.solve(data_.pairs, kShare, data_.points, data_.pulls, hold_, context_);
  EXPECT_EQ(other.solve(data_.pairs, kShare, data_.points, data_.pulls, hold_, two).q, one.q);
}

// A bar along z whose ends are pulled apart; there is nothing to say of the middle, however soft it is.
TEST(SoftSystem, WhatNoDataHoldFollowsTheRest) {
  const RunContext context;
  const GeneratedModel bar = generate("bar");
  const Subspace subspace = build_subspace(bar.mesh, bar.truth, {}, context);
  FitSystem system(subspace, bar.mesh, 0.3);
  FitSystem::Hold hold;
  hold.stiffness = 1e-4;
  hold.around = Eigen::VectorXd::Zero(subspace.degrees_of_freedom());
  constexpr double kEnd = 3;
  constexpr double kPulled = 0.2;
  std::vector<Pull> pulls;
  for (int v = 0; v < bar.mesh.vertices.rows(); ++v) {
    const Eigen::Vector3d vertex = bar.mesh.vertices.row(v);
    if (std::abs(vertex.z()) < kEnd) continue;
    pulls.push_back({v, vertex + kPulled * Eigen::Vector3d(0, 0, vertex.z() < 0 ? -1 : 1), 1});
  }
  const FitSystem::Solution solution = system.solve({}, 1, Points(0, 3), pulls, hold, context);
  const Points moved = vertex_displacements(subspace, solution.q);
  for (Eigen::Index v = 0; v < moved.rows(); ++v) {
    const double z = bar.mesh.vertices(v, 2);
    if (std::abs(z) >= kEnd) continue;
    EXPECT_NEAR(moved(v, 2), kPulled * z / kEnd, 0.15 * kPulled) << "at " << z;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, System,
                         testing::Values(SystemCase{"bar", false}, SystemCase{"table", false}, SystemCase{"bar", true},
                                         SystemCase{"table", true}),
                         [](const auto& each) { return testing::PrintToString(each.param); });

}  // namespace
}  // namespace orbifit
