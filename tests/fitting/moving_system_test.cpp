#include "solver/moving_system.h"

#include <cmath>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "geometry/sampling.h"
#include "registration/alignment.h"

namespace orbifit {
namespace {

SubspaceOptions options_of_moving() {
  SubspaceOptions options;
  options.mode = GroupMode::moving;
  options.samples = 150;
  return options;
}

class MovingGroups : public testing::TestWithParam<const char*> {
 protected:
  MovingGroups()
      : model_(generate(GetParam())),
        subspace_(build_subspace(model_.mesh, model_.truth, options_of_moving(), context_)),
        system_(subspace_, model_.mesh, 0.3),
        size_(diagonal(model_.mesh.vertices)) {}

  Eigen::VectorXd coordinates(double most) {
    Eigen::VectorXd q(subspace_.degrees_of_freedom());
    for (double& value : q) value = most * size_ * random_.uniform(-1, 1);
    return q;
  }

  RunContext context_;
  GeneratedModel model_;
  Subspace subspace_;
  MovingSystem system_;
  double size_;
  Random random_{3};
};

TEST_P(MovingGroups, StandAtFirstAsTheyFloat) {
  const Eigen::VectorXd q = coordinates(0.01);
  const Eigen::VectorXd all = system_.at_rest(q);
  EXPECT_LT((system_.samples_at(all) - sample_displacements(subspace_, q)).cwiseAbs().maxCoeff(), 1e-12 * size_);
  EXPECT_LT((system_.vertices_at(all, context_) - vertex_displacements(subspace_, q)).cwiseAbs().maxCoeff(),
            1e-12 * size_);
}

// Each vertex is told where turned groups take it, in all three directions.
TEST_P(MovingGroups, AreFoundAsTheyWereTurned) {
  const ConjugatedRegions regions(subspace_);
  ASSERT_GT(regions.freedom(), 0);
  Eigen::VectorXd angles(regions.freedom());
  for (double& angle : angles) angle = random_.uniform(-0.2, 0.2);
  const SubspaceState truth{coordinates(0), std::make_shared<const ConjugatedBasis>(conjugated_basis(
                                                subspace_, regions.rotations(regions.turned(regions.rest(), angles))))};
  const Points there = model_.mesh.vertices + vertex_displacements(subspace_, truth);
  const SurfaceSamples samples = sample_surface(model_.mesh, 1500, random_);
  Points goals(samples.points.rows(), 3);
  std::vector<Correspondence> pairs;
  for (Eigen::Index i = 0; i < goals.rows(); ++i) {
    Correspondence pair;
    pair.scan_point = static_cast<int>(i);
    pair.face = samples.faces[static_cast<std::size_t>(i)];
    pair.barycentric = Eigen::Vector3d(random_.uniform(), random_.uniform(), random_.uniform());
    pair.barycentric /= pair.barycentric.sum();
    pair.weight = 1;
    goals.row(i) = pair.barycentric.transpose() * there(model_.mesh.faces.row(pair.face), Eigen::all);
    for (int c = 0; c < 3; ++c) {
      pair.normal = Eigen::Vector3d::Unit(c);
      pairs.push_back(pair);
    }
  }
  const auto worst = [&](const Eigen::VectorXd& q) {
    const Points now = model_.mesh.vertices + system_.vertices_at(q, context_);
    double result = 0;
    for (const Correspondence& pair : pairs) {
      const Eigen::RowVector3d foot = pair.barycentric.transpose() * now(model_.mesh.faces.row(pair.face), Eigen::all);
      result = std::max(result, (foot - goals.row(pair.scan_point)).norm());
    }
    return result / size_;
  };
  Eigen::VectorXd q = system_.at_rest(coordinates(0));
  const double before = worst(q);
  EXPECT_GT(before, 0.01);
  for (int step = 0; step < 5; ++step) {
    const auto solution = system_.solve(pairs, 1, goals, {}, {.stiffness = 1e-5, .damping = 0, .around = q}, context_);
    for (Eigen::Index i = 0; i < goals.rows(); ++i) {
      goals.row(i) = solution.scan_step(goals.row(i).transpose()).transpose();
    }
    q = solution.q;
    system_.rotate(q);
  }
  EXPECT_LT(worst(q), 1e-3 * before);
  EXPECT_LT(worst_field_residual(subspace_, model_.mesh, model_.truth, system_.state_of(q), context_), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Models, MovingGroups, testing::Values("chair", "table", "armchair"),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace orbifit
