// Mode moving: groups turn as the handles ask, and stay exact.

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/conjugated_regions.h"
#include "basis/subspace_parts.h"
#include "subspaces.h"

namespace orbifit {
namespace {

const Region& region_named(const GeneratedModel& model, const std::string& name, int& number) {
  for (std::size_t i = 0; i < model.truth.regions.size(); ++i) {
    if (model.truth.regions[i].name != name) continue;
    number = static_cast<int>(i);
    return model.truth.regions[i];
  }
  throw std::runtime_error("no region " + name);
}

// The groups' motions alone.
DeformerOptions without_contacts() {
  DeformerOptions options;
  options.contacts = false;
  return options;
}

struct Splay {
  explicit Splay(GroupMode mode) : model(generate("table", {{"detail", 1}})), subspace(subspace_of(model, mode, 0.06)) {
    const Mesh& mesh = model.mesh;
    Eigen::Index foot = 0;
    (mesh.vertices.col(0) + mesh.vertices.col(1) - 10 * mesh.vertices.col(2)).maxCoeff(&foot);
    Deformer deformer(subspace, mesh);
    deformer.set_handles({handle_at(mesh, {0, 0, 0.74}, 0.25), handle_at(mesh, mesh.vertices.row(foot), 0.08)}, 100);
    result = deformer.solve({Motion{}, Motion{Eigen::Matrix3d::Identity(), {0.15, 0.15, 0}}}, 30);
  }

  // By how many degrees the line from a leg's foot to its upper end has turned.
  double tilt() const {
    int leg = 0;
    const Region& region = region_named(model, "leg 1", leg);
    const Points moved = model.mesh.vertices + vertex_displacements(subspace, result.state);
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
    int lows = 0, highs = 0;
    for (const int v : vertices_of_faces(model.mesh, region.faces)) {
      const double z = model.mesh.vertices(v, 2);
      if (z < 0.05) low += moved.row(v).transpose(), ++lows;
      if (z > 0.65) high += moved.row(v).transpose(), ++highs;
    }
    const Eigen::Vector3d up = (high / highs - low / lows).normalized();
    return std::acos(std::min(1.0, up[2])) * 180 / M_PI;
  }

  GeneratedModel model;
  Subspace subspace;
  Deformation result;
};

TEST(Moving, ATablesLegsSplay) {
  const Splay floating(GroupMode::floating);
  const Splay moving(GroupMode::moving);
  EXPECT_LT(floating.tilt(), 1e-6);
  EXPECT_GT(moving.tilt(), 4);
  EXPECT_LT(moving.result.handle_error, floating.result.handle_error);
  const WorstResidual worst = worst_residual(moving.model, moving.subspace, moving.result.state, 1000);
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
}

// Q_j = g Q_i g^-1 for the table's legs, and so for where their axes go.
TEST(Moving, LegsSplayAlike) {
  const Splay splay(GroupMode::moving);
  const Motion whole = region_motion(splay.subspace, splay.result.state, 0);
  int number = 0;
  region_named(splay.model, "leg 1", number);
  const Region& first = splay.model.truth.regions[static_cast<std::size_t>(number)];
  int images = 0;
  for (const Motion& element : splay.model.truth.regions[0].elements) {
    for (std::size_t j = 0; j < splay.model.truth.regions.size(); ++j) {
      const Region& other = splay.model.truth.regions[j];
      if (other.name.rfind("leg", 0) != 0 || (element(first.centre) - other.centre).norm() > 1e-9) continue;
      const Motion carried = conjugate(whole, element);
      const Motion here = region_motion(splay.subspace, splay.result.state, number);
      const Motion there = region_motion(splay.subspace, splay.result.state, static_cast<int>(j));
      const Eigen::Vector3d due = carried.linear * here.linear * first.axis;
      EXPECT_LT((there.linear * other.axis).cross(due).norm(), 1e-10);
      ++images;
    }
  }
  EXPECT_EQ(images, 8);
}

TEST(Moving, ACarsWheelsFollowItsNose) {
  const GeneratedModel model = generate("car", {{"detail", 1}});
  const Subspace subspace = subspace_of(model, GroupMode::moving, 0.1);
  Deformer deformer(subspace, model.mesh, without_contacts());
  deformer.set_handles({handle_at(model.mesh, {-2.1, 0, 0.5}, 0.5), handle_at(model.mesh, {2.1, 0, 0.5}, 0.5)}, 100);
  const Deformation result = deformer.solve({Motion{}, Motion{Eigen::Matrix3d::Identity(), {0.7, 0, 0}}}, 10);
  int front = 0;
  int rear = 0;
  region_named(model, "front left wheel", front);
  region_named(model, "rear left wheel", rear);
  const auto gone = [&](int wheel) {
    const Eigen::Vector3d& centre = model.truth.regions[static_cast<std::size_t>(wheel)].centre;
    return region_motion(subspace, result.state, wheel)(centre)[0] - centre[0];
  };
  EXPECT_GT(gone(front), gone(rear) + 0.2);
  const WorstResidual worst = worst_residual(model, subspace, result.state, 60);
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
}

class MovingModel : public testing::TestWithParam<const char*> {
 protected:
  MovingModel() : model_(generate(GetParam())), subspace_(subspace_of(model_, GroupMode::moving, 0.08)) {}

  // Three handles that hold the shape everywhere.
  std::vector<Handle> handles() const {
    std::vector<Handle> result;
    for (const Eigen::Vector3d& way :
         {Eigen::Vector3d(1, 0.2, 0.1), Eigen::Vector3d(-0.5, 1, -1), Eigen::Vector3d(-0.3, -0.9, 0.8)}) {
      Eigen::Index vertex = 0;
      (model_.mesh.vertices * way).maxCoeff(&vertex);
      result.push_back(handle_at(model_.mesh, model_.mesh.vertices.row(vertex).transpose(), 0.1 * subspace_->diagonal));
    }
    return result;
  }

  GeneratedModel model_;
  Subspace subspace_;
};

TEST_P(MovingModel, RestPoseIsAFixedPoint) {
  Deformer deformer(subspace_, model_.mesh);
  deformer.set_handles(handles(), 100);
  const Deformation result = deformer.solve(std::vector<Motion>(3), 10);
  EXPECT_LT(vertex_displacements(subspace_, result.state).rowwise().norm().maxCoeff(), 1e-9 * subspace_->diagonal);
  EXPECT_LT(result.handle_error, 1e-9 * subspace_->diagonal);
}

TEST_P(MovingModel, RigidMotionOfAllHandlesMovesEverythingRigidly) {
  Deformer deformer(subspace_, model_.mesh, without_contacts());
  deformer.set_handles(handles(), 100);
  Motion motion = Motion::rotation(Eigen::Vector3d(1, 2, 3).normalized(), 0.8, {0.1, 0.2, 0.3});
  motion.translation += subspace_->diagonal * Eigen::Vector3d(0.4, -0.3, 0.2);
  const Deformation result = deformer.solve(std::vector<Motion>(3, motion), 150);
  const Points moved = model_.mesh.vertices + vertex_displacements(subspace_, result.state);
  double worst = 0;
  for (Eigen::Index v = 0; v < moved.rows(); ++v) {
    worst = std::max(worst, (moved.row(v).transpose() - motion(model_.mesh.vertices.row(v).transpose())).norm());
  }
  EXPECT_LT(worst, 1e-6 * subspace_->diagonal);
}

INSTANTIATE_TEST_SUITE_P(Models, MovingModel, testing::Values("bar", "table", "chair"));

// Two vertices leave a turn about their line open: what is decided by next to nothing is still decided alike, whatever
// the last digits.
TEST(Moving, LastDigitsDoNotGrow) {
  const GeneratedModel model = generate("bar");
  const Subspace subspace = subspace_of(model, GroupMode::moving, 0.08);
  Deformer deformer(subspace, model.mesh);
  Handle pulled, held;
  pulled.vertices = {0};
  held.vertices = {9};
  deformer.set_handles({pulled, held}, 100);
  const auto displaced = [&](double pull) {
    const Motion motion{Eigen::Matrix3d::Identity(), subspace->diagonal * Eigen::Vector3d(pull, 0, 0.002)};
    return vertex_displacements(subspace, deformer.solve({motion, Motion{}}, 10).state);
  };
  const double change = (displaced(0.004 + 1e-15) - displaced(0.004)).rowwise().norm().maxCoeff();
  EXPECT_LT(change, 1e-12 * subspace->diagonal);
}

// The bar's group would hold it straight: a part of it has none.
TEST(Moving, BarBentByNinetyDegreesHasNoFlippedTriangles) {
  GeneratedModel model = generate("bar");
  model.truth.regions.clear();
  const Subspace subspace = subspace_of(model, GroupMode::moving, 0.05);
  const Mesh& mesh = model.mesh;
  Deformer deformer(subspace, mesh);
  deformer.set_handles({handle_at(mesh, {0, 0, -4}, 1.2), handle_at(mesh, {0, 0, 4}, 1.2)}, 100);
  Deformation deformation;
  for (int step = 1; step <= 9; ++step) {
    const Motion turn = Motion::rotation(Eigen::Vector3d::UnitY(), step * M_PI / 18, {0, 0, 0});
    deformation = deformer.solve({Motion{}, turn}, 20, deformation.state);
  }
  Mesh bent = mesh;
  bent.vertices += vertex_displacements(subspace, deformation.state);
  const Points before = face_normals(mesh);
  const Points after = face_normals(bent);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const double share = std::clamp((mesh.vertices(mesh.faces(f, 0), 2) + 4) / 8, 0.0, 1.0);
    const Eigen::Matrix3d turned = axis_rotation(Eigen::Vector3d::UnitY(), share * M_PI / 2);
    ASSERT_GT(after.row(f).dot((turned * before.row(f).transpose()).transpose()), 0) << "face " << f;
  }
}

}  // namespace
}  // namespace orbifit
