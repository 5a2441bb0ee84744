// What a state adds to the displacement of its coordinates is as symmetric as that: at vertices and between them.

#include "deformation/surface_detail.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "subspaces.h"

namespace orbifit {
namespace {

struct Case {
  const char* model;
  GroupMode mode;
  bool irregular;

  friend void PrintTo(const Case& each, std::ostream* out) {
    *out << each.model << "_" << to_string(each.mode) << (each.irregular ? "_irregular" : "");
  }
};

GeneratedModel model_of(const Case& each) {
  const GeneratedModel model = generate(each.model, {{"detail", 1}});
  return each.irregular ? cut_irregularly(model) : model;
}

class Detail : public testing::TestWithParam<Case> {
 protected:
  // Heights of about that share of the diagonal along directions that follow nothing.
  SubspaceState with_detail(const SubspaceState& state, double size) const {
    Random random(3, "detail");
    Points directions(model_.mesh.vertices.rows(), 3);
    for (double& each : directions.reshaped()) each = random.normal();
    Eigen::VectorXd heights(subspace_->orbits.representatives());
    for (double& each : heights) each = size * subspace_.diagonal() * random.normal();
    const auto surface = std::make_shared<const SurfaceVectors>(model_.mesh);
    const DetailMap map = detail_map(subspace_, state, *surface, directions, RunContext{});
    SubspaceState result = state;
    result.detail = surface_detail(subspace_, surface, map, directions, heights);
    return result;
  }

  GeneratedModel model_ = model_of(GetParam());
  Subspace subspace_ = subspace_of(model_, GetParam().mode, 0.1);
};

TEST_P(Detail, IsAsSymmetricAsTheDisplacement) {
  const SubspaceState state = with_detail(random_state(subspace_, 0.02), 0.02);
  const WorstResidual worst = worst_residual(model_, subspace_, state, 300);
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
}

TEST_P(Detail, IsSeenAtTheVertices) {
  const SubspaceState state = random_state(subspace_, 0.02);
  const Points moved =
      vertex_displacements(subspace_, with_detail(state, 0.02)) - vertex_displacements(subspace_, state);
  EXPECT_GT(moved.rowwise().norm().mean(), 1e-3 * subspace_.diagonal());
  const Points none = vertex_displacements(subspace_, with_detail(state, 0)) - vertex_displacements(subspace_, state);
  EXPECT_EQ(none.cwiseAbs().maxCoeff(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Models, Detail,
    testing::Values(Case{"table", GroupMode::fixed, false}, Case{"table", GroupMode::floating, true},
                    Case{"table", GroupMode::moving, true}, Case{"car", GroupMode::floating, false},
                    Case{"chair", GroupMode::moving, false}, Case{"centre_piece", GroupMode::floating, true},
                    Case{"fan", GroupMode::floating, false}));

}  // namespace
}  // namespace orbifit
