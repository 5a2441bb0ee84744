#include "orbifit/subspace/deformer.h"

#include <string>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "deformation/corotation.h"
#include "subspaces.h"

namespace orbifit {
namespace {

struct Edit {
  explicit Edit(const std::string& name, GroupMode mode = GroupMode::floating, bool symmetric = true)
      : model(generate(name)) {
    if (!symmetric) model.truth.regions.clear();
    SubspaceOptions options;
    options.mode = mode;
    options.radius = 0.05 * diagonal(model.mesh.vertices);
    subspace = build_subspace(model.mesh, model.truth, options, RunContext{});
  }

  Points deformed(const Deformation& deformation) const {
    return model.mesh.vertices + vertex_displacements(subspace, deformation.state);
  }

  GeneratedModel model;
  Subspace subspace;
};

class RestPose : public testing::TestWithParam<const char*> {};

TEST_P(RestPose, IsAFixedPoint) {
  const Edit edit(GetParam());
  Deformer deformer(edit.subspace, edit.model.mesh);
  const double size = diagonal(edit.model.mesh.vertices);
  deformer.set_handles({handle_at(edit.model.mesh, edit.model.mesh.vertices.row(0).transpose(), 0.2 * size)}, 100);
  const Deformation deformation = deformer.solve({Motion{}}, 10);
  EXPECT_LT((edit.deformed(deformation) - edit.model.mesh.vertices).norm(), 1e-9 * size);
  EXPECT_LT(deformation.energy, 1e-16 * size * size);
}

INSTANTIATE_TEST_SUITE_P(Models, RestPose, testing::Values("bar", "table", "chair"));

// Without symmetry nothing hinders a rigid motion of everything.
TEST(Deformer, RigidMotionOfAllHandlesMovesEverythingRigidly) {
  const Edit edit("bar", GroupMode::fixed, false);
  const Mesh& mesh = edit.model.mesh;
  Deformer deformer(edit.subspace, mesh);
  deformer.set_handles({handle_at(mesh, {0, 0, -4}, 1.2), handle_at(mesh, {0, 0, 4}, 1.2)}, 100);
  Motion motion = Motion::rotation(Eigen::Vector3d(1, 2, 3).normalized(), 0.8, {0.1, 0.2, 0.3});
  motion.translation += Eigen::Vector3d(0.4, -0.3, 0.2);
  const Points result = edit.deformed(deformer.solve({motion, motion}, 400));
  Points expected(mesh.vertices.rows(), 3);
  for (Eigen::Index v = 0; v < expected.rows(); ++v) {
    expected.row(v) = motion(mesh.vertices.row(v).transpose()).transpose();
  }
  // What remains is the lift's smoothing of the linear field u(p) = (R - 1) p + t.
  EXPECT_LT((result - expected).rowwise().norm().maxCoeff(), 0.05 * diagonal(mesh.vertices));
}

TEST(Deformer, TranslationOfAllHandlesTranslatesEverythingExactly) {
  const Edit edit("table");
  const Mesh& mesh = edit.model.mesh;
  Deformer deformer(edit.subspace, mesh);
  deformer.set_handles({handle_at(mesh, mesh.vertices.row(0).transpose(), 0.3)}, 100);
  const Eigen::Vector3d shift(0.1, -0.2, 0.3);
  const Points result = edit.deformed(deformer.solve({Motion{Eigen::Matrix3d::Identity(), shift}}, 5));
  const Points missed = (result - mesh.vertices).rowwise() - shift.transpose();
  EXPECT_LT(missed.rowwise().norm().maxCoeff(), 1e-8 * diagonal(mesh.vertices));
}

// Handles that contradict the symmetry are met in the least-squares sense, never by breaking it.
TEST(Deformer, ContradictingHandlesDoNotBreakTheSymmetry) {
  const Edit edit("bar", GroupMode::fixed);
  const Mesh& mesh = edit.model.mesh;
  Deformer deformer(edit.subspace, mesh);
  deformer.set_handles({handle_at(mesh, {0, 0, -4}, 1), handle_at(mesh, {0, 0, 4}, 1)}, 100);
  const Motion along{Eigen::Matrix3d::Identity(), {0, 0, 0.5}};
  const Motion twice{Eigen::Matrix3d::Identity(), {0, 0, 1.0}};
  const Deformation deformation = deformer.solve({along, twice}, 10);
  Mesh deformed = mesh;
  deformed.vertices = edit.deformed(deformation);
  RunContext context;
  SymmetryAnnotation whole = edit.model.truth;
  whole.patterns.clear();
  EXPECT_LT(symmetry_residual(mesh, whole, &deformed, CarriedMotions::fixed, context).worst_excess, 1e-12);
  EXPECT_GT(deformation.handle_error, 0.1);
}

// The factorised system is the energy's: no nearby coordinates have less of it (linear editing, one iteration).
TEST(Deformer, SolutionMinimisesTheEnergy) {
  const Edit edit("table");
  const Mesh& mesh = edit.model.mesh;
  const double alpha = 50;
  const Corotation rest = corotation(edit.subspace->sampling.points, 2 * edit.subspace->sampling.radius);
  const std::vector<Eigen::Matrix3d> still(static_cast<std::size_t>(rest.rest.rows()), Eigen::Matrix3d::Identity());
  DeformerOptions options;
  options.contacts = false;  // the energy of equation (3) alone
  Deformer deformer(edit.subspace, mesh, options);
  const Handle foot = handle_at(mesh, mesh.vertices.row(0).transpose(), 0.2);
  const Handle top = handle_at(mesh, {0, 0, 0.74}, 0.2);
  ASSERT_FALSE(top.vertices.empty());
  deformer.set_handles({foot, top}, alpha);
  const Motion motion{Eigen::Matrix3d::Identity(), {0.05, 0.02, 0.1}};
  const Deformation solution = deformer.solve({Motion{}, motion}, 1);
  // Along directions that leave the handles' vertices in place the Laplace energy alone must have no slope.
  std::vector<int> held = foot.vertices;
  held.insert(held.end(), top.vertices.begin(), top.vertices.end());
  Eigen::MatrixXd handle_rows(3 * static_cast<Eigen::Index>(held.size()), solution.state.q.size());
  for (Eigen::Index c = 0; c < solution.state.q.size(); ++c) {
    const Points moved = vertex_displacements(edit.subspace, Eigen::VectorXd::Unit(solution.state.q.size(), c));
    for (std::size_t i = 0; i < held.size(); ++i) {
      handle_rows.block<3, 1>(3 * static_cast<Eigen::Index>(i), c) = moved.row(held[i]).transpose();
    }
  }
  const Eigen::MatrixXd kernel = Eigen::FullPivLU<Eigen::MatrixXd>(handle_rows).kernel();
  ASSERT_GT(kernel.cols(), 1);
  Random random(4);
  const auto slope = [&](Eigen::VectorXd direction) {
    direction *= 1e-3 / direction.norm();
    const auto energy = [&](const Eigen::VectorXd& q) {
      return laplace_energy(rest, still, sample_displacements(edit.subspace, q));
    };
    return std::abs(energy(solution.state.q + direction) - energy(solution.state.q - direction)) / 2;
  };
  const auto normal = [&] { return random.normal(); };
  for (int trial = 0; trial < 10; ++trial) {
    const double free = slope(Eigen::VectorXd::NullaryExpr(solution.state.q.size(), normal));
    EXPECT_LT(slope(kernel * Eigen::VectorXd::NullaryExpr(kernel.cols(), normal)), 1e-5 * free) << "trial " << trial;
  }
}

TEST(Deformer, BarBentByNinetyDegreesHasNoFlippedTriangles) {
  const Edit edit("bar", GroupMode::fixed, false);
  const Mesh& mesh = edit.model.mesh;
  Deformer deformer(edit.subspace, mesh);
  deformer.set_handles({handle_at(mesh, {0, 0, -4}, 1.2), handle_at(mesh, {0, 0, 4}, 1.2)}, 100);
  Deformation deformation;
  const Motion still;
  for (int step = 1; step <= 9; ++step) {
    const Motion turn = Motion::rotation(Eigen::Vector3d::UnitY(), step * M_PI / 18, {0, 0, 0});
    deformation = deformer.solve({still, turn}, 40, deformation.state);
  }
  Mesh bent = mesh;
  bent.vertices = edit.deformed(deformation);
  const Points before = face_normals(mesh);
  const Points after = face_normals(bent);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    // Every normal turns by an angle between those of the two ends.
    const double z = mesh.vertices(mesh.faces(f, 0), 2);
    const double share = std::clamp((z + 4) / 8, 0.0, 1.0);
    const Eigen::Matrix3d turned = axis_rotation(Eigen::Vector3d::UnitY(), share * M_PI / 2);
    EXPECT_GT(after.row(f).dot((turned * before.row(f).transpose()).transpose()), 0) << "face " << f;
  }
}

TEST(Deformer, SolvesTheSameWhateverWasSolvedBefore) {
  const Edit edit("table");
  Deformer deformer(edit.subspace, edit.model.mesh);
  deformer.set_handles({handle_at(edit.model.mesh, edit.model.mesh.vertices.row(0).transpose(), 0.2)}, 100);
  const Motion motion{Eigen::Matrix3d::Identity(), {0.05, 0.02, 0.1}};
  const Eigen::VectorXd first = deformer.solve({motion}, 5).state.q;
  deformer.solve({Motion{Eigen::Matrix3d::Identity(), {1, 1, 1}}}, 5);
  EXPECT_EQ(deformer.solve({motion}, 5).state.q, first);
}

TEST(Deformer, RefusesAsManyMotionsAsThereAreNoHandles) {
  const Edit edit("bar");
  Deformer deformer(edit.subspace, edit.model.mesh);
  deformer.set_handles({handle_at(edit.model.mesh, {0, 0, 4}, 1.2)}, 100);
  EXPECT_THROW(deformer.solve({}, 5), UsageError);
  EXPECT_THROW(deformer.set_handles({Handle{}}, 100), UsageError);
}

}  // namespace
}  // namespace orbifit
