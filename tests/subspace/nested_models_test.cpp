// An aeroplane and an armchair put together by hand: groups within groups on both sides of a mirror, surfaces of
// revolution on the axes of finite groups. After a drag of two handles, one of them turned, every group is exact.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/consistent_annotation.h"
#include "orbifit/subspace/deformer.h"

#include "geometry/vertex_grid.h"
#include "parts.h"
#include "subspaces.h"

namespace orbifit {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Motion moved_to(double x, double y, double z) {
  return {Matrix3d::Identity(), {x, y, z}};
}

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<int> every_face(const Mesh& mesh) {
  std::vector<int> result(static_cast<std::size_t>(mesh.faces.rows()));
  for (std::size_t f = 0; f < result.size(); ++f) result[f] = static_cast<int>(f);
  return result;
}

// Faces keep facing outwards, also under a reflection.
std::vector<int> append_placed(Mesh& mesh, const Mesh& part, const Motion& motion) {
  Mesh there = placed(part, motion);
  if (motion.linear.determinant() < 0) there.faces.col(1).swap(there.faces.col(2));
  return append(mesh, there);
}

void declare(GeneratedModel& model, const char* group, const Vector3d& centre, const GroupFrame& frame,
             const std::vector<int>& faces, const std::string& name) {
  Region region = make_region(PointGroup::parse(group).value(), centre, frame, faces, name);
  region.id = static_cast<int>(model.truth.regions.size());
  model.truth.regions.push_back(std::move(region));
}

// A bar whose upper side is narrower, so that x -> -x and y -> -y are its only symmetries.
Mesh tapered(const Vector3d& half, int cells) {
  Mesh mesh = box(half, cells);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const double narrow = 1 - 0.25 * (mesh.vertices(v, 2) / half[2] + 1) / 2;
    mesh.vertices(v, 0) *= narrow;
    mesh.vertices(v, 1) *= narrow;
  }
  return mesh;
}

// Cs (x -> -x) of the whole; at x = +-0.36 engines C4 about y, with blades set at an angle, each with a nacelle Cinfv
// on that axis.
GeneratedModel aeroplane() {
  constexpr double kEngine = 0.36;
  GeneratedModel model;
  Mesh& mesh = model.mesh;
  append(mesh, placed(tapered({0.12, 0.9, 0.13}, 8), moved_to(0, 0.05, 0)));
  append(mesh, placed(box({0.95, 0.16, 0.02}, 10), moved_to(0, 0.15, 0.03)));
  append(mesh, placed(box({0.35, 0.09, 0.015}, 5), moved_to(0, -0.8, 0.1)));
  append(mesh, placed(tapered({0.015, 0.1, 0.16}, 4), moved_to(0, -0.8, 0.28)));
  const Motion forwards = Motion::about(axis_rotation(Vector3d::UnitX(), -std::numbers::pi / 2), Vector3d::Zero());
  const Mesh nacelle = turned_part({{0, -0.25}, {0.05, -0.22}, {0.08, -0.05}, {0.08, 0.1}, {0.04, 0.2}, {0, 0.22}},
                                   irregular_angles(17));
  const Mesh blade = placed(box({0.012, 0.05, 0.09}, 3), Motion::rotation(Vector3d::UnitZ(), 0.6, Vector3d::Zero()));
  const Motion mirror = Motion::reflection(Vector3d::UnitX(), Vector3d::Zero());
  std::vector<std::vector<int>> nacelles;
  std::vector<std::vector<int>> engines;
  for (const bool left : {false, true}) {
    Motion there = moved_to(kEngine, 0.2, -0.06);
    if (left) there = mirror * there;
    nacelles.push_back(append_placed(mesh, nacelle, there * forwards));
    engines.push_back(nacelles.back());
    for (int k = 0; k < 4; ++k) {
      const Motion turn = Motion::rotation(Vector3d::UnitY(), k * std::numbers::pi / 2, Vector3d::Zero());
      engines.back() = joined(engines.back(), append_placed(mesh, blade, there * turn * moved_to(0, 0.2, 0.13)));
    }
  }
  model.truth = empty_annotation(mesh, 0.005);
  declare(model, "Cs", Vector3d::Zero(), frame_about(Vector3d::UnitX()), every_face(mesh), "whole");
  for (std::size_t side = 0; side < 2; ++side) {
    const Vector3d centre(side == 0 ? kEngine : -kEngine, 0.2, -0.06);
    declare(model, "C4", centre, frame_about(Vector3d::UnitY()), engines[side], "engine");
    declare(model, "Cinfv", centre, frame_about(Vector3d::UnitY()), nacelles[side], "nacelle");
  }
  set_parents(model.truth.regions);
  return model;
}

// Cs (x -> -x) of the whole; a star base C5v, one of whose legs points to the front, with a column Cinfv inside.
GeneratedModel armchair() {
  GeneratedModel model;
  Mesh& mesh = model.mesh;
  append(mesh, placed(tapered({0.3, 0.28, 0.05}, 8), moved_to(0, 0.02, 0.48)));
  append(mesh, placed(tapered({0.28, 0.04, 0.3}, 8), moved_to(0, -0.26, 0.82)));
  for (const double side : {-1.0, 1.0}) append(mesh, placed(box({0.03, 0.2, 0.03}, 4), moved_to(0.32 * side, 0, 0.68)));
  const Mesh column =
      turned_part({{0, 0.05}, {0.05, 0.06}, {0.05, 0.2}, {0.03, 0.22}, {0.03, 0.42}, {0, 0.43}}, irregular_angles(19));
  const std::vector<int> pillar = append(mesh, column);
  std::vector<int> base = pillar;
  const Mesh leg = placed(tapered({0.03, 0.14, 0.02}, 4), moved_to(0, 0.19, 0.08));
  for (int k = 0; k < 5; ++k) {
    const Motion turn = Motion::rotation(Vector3d::UnitZ(), 2 * k * std::numbers::pi / 5, Vector3d::Zero());
    base = joined(base, append(mesh, placed(leg, turn)));
  }
  GroupFrame frame;
  frame << Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ();
  model.truth = empty_annotation(mesh, 0.005);
  declare(model, "Cs", Vector3d::Zero(), frame_about(Vector3d::UnitX()), every_face(mesh), "whole");
  declare(model, "C5v", Vector3d::Zero(), frame, base, "base");
  declare(model, "Cinfv", Vector3d::Zero(), frame_about(Vector3d::UnitZ()), pillar, "column");
  set_parents(model.truth.regions);
  return model;
}

// How far the images of vertices that are vertices are from where the carried groups take them, of the diagonal.
double worst_of_mesh(const GeneratedModel& model, const Subspace& subspace, const SubspaceState& state) {
  const Points& rest = model.mesh.vertices;
  const Points moved = rest + vertex_displacements(subspace, state);
  const VertexGrid grid(rest, 1e-9 * subspace->diagonal);
  double worst = 0;
  int pairs = 0;
  for (std::size_t i = 0; i < model.truth.regions.size(); ++i) {
    const Region& region = model.truth.regions[i];
    const Motion carried = region_motion(subspace, state, static_cast<int>(i));
    const std::vector<int> inside = vertices_of_faces(model.mesh, region.faces);
    for (const Motion& element : subspace->regions->test_elements(static_cast<int>(i))) {
      for (const int v : inside) {
        const Vector3d due = conjugate(carried, element)(moved.row(v).transpose());
        double least = -1;
        grid.visit(element(rest.row(v).transpose()), [&](int other) {
          if (!std::ranges::binary_search(inside, other)) return;
          const double apart = (moved.row(other).transpose() - due).norm() / subspace->diagonal;
          if (least < 0 || apart < least) least = apart;
        });
        if (least < 0) continue;
        worst = std::max(worst, least);
        ++pairs;
      }
    }
  }
  EXPECT_GT(pairs, 1000);
  return worst;
}

struct NestedCase {
  const char* name;
  GeneratedModel (*make)();
  Vector3d held, turned;  // where the handles are
};

const NestedCase kNestedCases[] = {{"aeroplane", aeroplane, {0.36, 0.4, -0.06}, {-0.9, 0.2, 0.03}},
                                   {"armchair", armchair, {0.1, 0.25, 0.08}, {0.2, -0.26, 1.05}}};

class NestedModel : public testing::TestWithParam<std::tuple<int, GroupMode>> {};

TEST_P(NestedModel, IsExactAfterADragThatTurns) {
  const NestedCase& chosen = kNestedCases[static_cast<std::size_t>(std::get<0>(GetParam()))];
  const GroupMode mode = std::get<1>(GetParam());
  const GeneratedModel model = chosen.make();
  const ConsistentAnnotation consistent = consistent_annotation(model.mesh, model.truth, RunContext{});
  ASSERT_TRUE(consistent.left_out.empty()) << to_string(consistent.left_out.front());
  const Subspace subspace = subspace_of(model, mode, 0.05);
  const double size = subspace->diagonal;
  Deformer deformer(subspace, model.mesh);
  deformer.set_handles(
      {handle_at(model.mesh, chosen.held, 0.08 * size), handle_at(model.mesh, chosen.turned, 0.08 * size)}, 100);
  Motion turn = Motion::rotation(Vector3d(1, 2, 2) / 3, 20 * std::numbers::pi / 180, chosen.turned);
  turn.translation += 0.05 * size * Vector3d(-1, 2, 1).normalized();
  const Deformation result =
      deformer.solve({Motion{Matrix3d::Identity(), 0.05 * size * Vector3d(1, 1, -1).normalized()}, turn}, 10);
  EXPECT_GT(vertex_displacements(subspace, result.state).rowwise().norm().maxCoeff(), 1e-3 * size);
  if (mode == GroupMode::moving) {
    double turned = 0;
    for (const Matrix3d& rotation : basis_of(subspace, result.state).rotations) {
      turned = std::max(turned, (rotation - Matrix3d::Identity()).norm());
    }
    EXPECT_GT(turned, 1e-3);  // else this were no test of groups that turn
  }
  const WorstResidual worst = worst_residual(model, subspace, result.state);
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
  EXPECT_LT(worst_of_mesh(model, subspace, result.state), 1e-12);
}

std::string nested_case_name(const testing::TestParamInfo<NestedModel::ParamType>& tested) {
  return std::string(kNestedCases[static_cast<std::size_t>(std::get<0>(tested.param))].name) + "_" +
         to_string(std::get<1>(tested.param));
}

INSTANTIATE_TEST_SUITE_P(Modes, NestedModel,
                         testing::Combine(testing::Range(0, 2),
                                          testing::Values(GroupMode::fixed, GroupMode::floating, GroupMode::moving)),
                         nested_case_name);

// A rotation conjugates a motion also where that does not fix the region's centre exactly, as by the digits of a file.
TEST(NestedModel, AGroupOffItsCentreByRoundingTurnsExactly) {
  GeneratedModel model = armchair();
  for (Region& region : model.truth.regions) {
    if (!region.group.continuous()) region.centre += 3e-10 * Vector3d(1, -1, 1);
  }
  const Subspace subspace = subspace_of(model, GroupMode::moving, 0.05);
  const WorstResidual worst = worst_residual(model, subspace, random_state(subspace, 0.02));
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
}

}  // namespace
}  // namespace orbifit
