// Patterns as constraints: instances stay congruent, lattices stay regular, their spacing may change.

#include <cmath>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/conjugated_regions.h"
#include "basis/subspace_parts.h"
#include "parts.h"
#include "subspaces.h"

namespace orbifit {
namespace {

using Kind = Pattern::Kind;

struct Row {
  const char* name;
  Kind kind;
  std::vector<Motion> generators;
  std::vector<int> counts;  // of each generator
};

const Motion kStep{Eigen::Matrix3d::Identity(), {0.5, 0, 0}};
const Motion kAcross{Eigen::Matrix3d::Identity(), {0.1, 0.5, 0}};

Motion screw_step() {
  return Motion{Eigen::Matrix3d::Identity(), {0, 0, 0.2}} *
         Motion::rotation(Eigen::Vector3d::UnitZ(), 0.4, {0, 1.2, 0});
}

std::vector<Row> rows() {
  return {{"row", Kind::translation_1d, {kStep}, {5}},
          {"grid", Kind::translation_2d, {kStep, kAcross}, {4, 3}},
          {"arc", Kind::rotation, {Motion::rotation(Eigen::Vector3d::UnitZ(), 0.35, {0, 1.3, 0})}, {5}},
          {"stair", Kind::screw, {screw_step()}, {6}},
          {"copies", Kind::congruent, {}, {4}}};
}

// Wedges that stand apart on a plate: no motion maps a wedge or the plate with them onto itself.
GeneratedModel model_of(const Row& row, const Mesh& part = wedge(0.3)) {
  GeneratedModel model;
  append(model.mesh, placed(box({1.6, 1.1, 0.05}, 6), {Eigen::Matrix3d::Identity(), {0.8, 0.4, -0.35}}));
  Pattern pattern;
  pattern.name = row.name;
  pattern.kind = row.kind;
  pattern.generators = row.generators;
  const auto add = [&](const Motion& motion) {
    pattern.instances.push_back({motion, append(model.mesh, placed(part, motion))});
  };
  if (row.kind == Kind::congruent) {
    Random random(12, "copies");
    for (int a = 0; a < row.counts[0]; ++a) {
      const Motion turn = Motion::rotation(random.direction(), a == 0 ? 0 : random.uniform(0.3, 3), {0, 0, 0});
      add(Motion{Eigen::Matrix3d::Identity(), {0.55 * a, 0.2 * (a % 2), 0.02 * a * a}} * turn);
    }
  } else {
    Motion outer;
    for (int b = 0; b < (row.counts.size() > 1 ? row.counts[1] : 1); ++b) {
      Motion motion = outer;
      for (int a = 0; a < row.counts[0]; ++a) {
        add(motion);
        motion = row.generators[0] * motion;
      }
      if (row.generators.size() > 1) outer = row.generators[1] * outer;
    }
  }
  model.truth = empty_annotation(model.mesh, 0.005);
  model.truth.patterns.push_back(pattern);
  return model;
}

using PatternCase = std::tuple<int, GroupMode>;

class PatternOfParts : public testing::TestWithParam<PatternCase> {
 protected:
  PatternOfParts()
      : row_(rows()[static_cast<std::size_t>(std::get<0>(GetParam()))]),
        mode_(std::get<1>(GetParam())),
        model_(model_of(row_)),
        subspace_(subspace_of(model_, mode_, 0.05)) {
    const Pattern& pattern = model_.truth.patterns[0];
    for (const PatternInstance& instance : pattern.instances) {
      vertices_.push_back(vertices_of_faces(model_.mesh, instance.faces));
    }
  }

  // The first instance held, the last one pulled away from it and turned.
  SubspaceState dragged() const {
    const Mesh& mesh = model_.mesh;
    Handle first;
    Handle last;
    first.name = "first";
    last.name = "last";
    first.vertices = vertices_.front();
    last.vertices = vertices_.back();
    Deformer deformer(subspace_, mesh);
    deformer.set_handles({first, last}, 100);
    const Eigen::Vector3d way = model_.truth.patterns[0].instances.back().motion(Eigen::Vector3d::Zero());
    return deformer.solve({Motion{}, Motion{Eigen::Matrix3d::Identity(), 0.4 * way + Eigen::Vector3d(0, 0.05, 0.1)}}, 6)
        .state;
  }

  // tau of y_a = O_a y_0 + tau, and the check that every vertex of the instance has it.
  std::vector<Eigen::Vector3d> translations(const Points& moved) const {
    std::vector<Eigen::Vector3d> result;
    for (std::size_t a = 0; a < vertices_.size(); ++a) {
      const Eigen::Matrix3d& linear = model_.truth.patterns[0].instances[a].motion.linear;
      const auto apart = [&](std::size_t k) {
        return Eigen::Vector3d(moved.row(vertices_[a][k]).transpose() -
                               linear * moved.row(vertices_[0][k]).transpose());
      };
      result.push_back(apart(0));
      for (std::size_t k = 0; k < vertices_[a].size(); ++k) {
        EXPECT_LT((apart(k) - result.back()).norm(), 1e-12 * subspace_->diagonal) << "instance " << a;
      }
    }
    return result;
  }

  Row row_;
  GroupMode mode_;
  GeneratedModel model_;
  Subspace subspace_;
  std::vector<std::vector<int>> vertices_;
};

TEST_P(PatternOfParts, IsExactUnderRandomCoordinates) {
  const SubspaceState state = random_state(subspace_, 0.03);
  EXPECT_LT(pattern_residual(subspace_, model_.mesh, model_.truth.patterns[0], 0, state, RunContext{}).max, 1e-12);
  translations(model_.mesh.vertices + vertex_displacements(subspace_, state));
}

TEST_P(PatternOfParts, IsExactBetweenVertices) {
  const GeneratedModel cut = cut_irregularly(model_);
  const Subspace subspace = subspace_of(cut, mode_, 0.05);
  EXPECT_LT(worst_residual(cut, subspace, random_state(subspace, 0.03)).residual, 1e-12);
}

TEST_P(PatternOfParts, StaysRegularAfterADragThatSpreadsIt) {
  const SubspaceState state = dragged();
  const Points moved = model_.mesh.vertices + vertex_displacements(subspace_, state);
  const std::vector<Eigen::Vector3d> tau = translations(moved);
  const double tolerance = 1e-12 * subspace_->diagonal;
  const Pattern& pattern = model_.truth.patterns[0];
  if (mode_ == GroupMode::fixed) {
    for (std::size_t a = 0; a < tau.size(); ++a) {
      EXPECT_LT((tau[a] - pattern.instances[a].motion.translation).norm(), tolerance) << "instance " << a;
    }
    return;
  }
  EXPECT_GT((tau.back() - pattern.instances.back().motion.translation).norm(), 0.1);
  // One more step is one more step: y_{a+1} = g' y_a for one g' of the generator's linear part.
  const auto expect_even = [&](std::size_t start, std::size_t stride, std::size_t count, std::size_t generator) {
    const Eigen::Matrix3d& linear = pattern.generators[generator].linear;
    const Eigen::Vector3d step = tau[start + stride] - linear * tau[start];
    for (std::size_t a = 1; a + 1 < count; ++a) {
      const Eigen::Vector3d next = tau[start + (a + 1) * stride] - linear * tau[start + a * stride];
      EXPECT_LT((next - step).norm(), tolerance) << "step " << a;
    }
  };
  const auto along = static_cast<std::size_t>(row_.counts[0]);
  if (row_.kind != Kind::congruent) expect_even(0, 1, along, 0);
  if (row_.kind == Kind::translation_2d) {
    expect_even(along, 1, along, 0);
    expect_even(1, along, 3, 1);
  }
}

TEST_P(PatternOfParts, CarriedAnnotationSaysWhereItWent) {
  const SubspaceState state = dragged();
  Mesh deformed = model_.mesh;
  deformed.vertices += vertex_displacements(subspace_, state);
  const Pattern carried = deformed_annotation(model_.truth, subspace_, state, deformed).patterns[0];
  const double tolerance = 1e-12 * subspace_->diagonal;
  ASSERT_EQ(carried.instances.size(), vertices_.size());
  for (std::size_t a = 0; a < vertices_.size(); ++a) {
    for (std::size_t k = 0; k < vertices_[a].size(); ++k) {
      const Eigen::Vector3d due = carried.instances[a].motion(deformed.vertices.row(vertices_[0][k]).transpose());
      ASSERT_LT((deformed.vertices.row(vertices_[a][k]).transpose() - due).norm(), tolerance) << "instance " << a;
    }
  }
  for (std::size_t g = 0; g < carried.generators.size(); ++g) {
    const auto stride = static_cast<std::size_t>(g == 0 ? 1 : row_.counts[0]);
    for (std::size_t a = 0; a + stride < vertices_.size(); a += stride) {
      if (g == 0 && (a + 1) % static_cast<std::size_t>(row_.counts[0]) == 0) continue;
      for (const int k : {0, 7}) {
        const Eigen::Vector3d from = deformed.vertices.row(vertices_[a][static_cast<std::size_t>(k)]).transpose();
        const Eigen::Vector3d to =
            deformed.vertices.row(vertices_[a + stride][static_cast<std::size_t>(k)]).transpose();
        EXPECT_LT((carried.generators[g](from) - to).norm(), tolerance) << "generator " << g << ", instance " << a;
      }
    }
  }
}

std::string pattern_case_name(const testing::TestParamInfo<PatternCase>& info) {
  return std::string(rows()[static_cast<std::size_t>(std::get<0>(info.param))].name) + "_" +
         to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Kinds, PatternOfParts,
                         testing::Combine(testing::Range(0, 5),
                                          testing::Values(GroupMode::fixed, GroupMode::floating, GroupMode::moving)),
                         pattern_case_name);

// A pattern inside a symmetric region: the row of boxes is its own mirror image.
TEST(PatternInARegion, KeepsBoth) {
  for (const GroupMode mode : {GroupMode::fixed, GroupMode::floating, GroupMode::moving}) {
    GeneratedModel model;
    append(model.mesh, box({1.5, 0.4, 0.05}, 6));
    Pattern pattern;
    pattern.name = "boxes";
    pattern.kind = Kind::translation_1d;
    pattern.generators = {kStep};
    for (int a = 0; a < 5; ++a) {
      const Eigen::Vector3d at(0.5 * (a - 2), 0, 0.3);
      const Mesh part = placed(box({0.15, 0.15, 0.15}, 3), {Eigen::Matrix3d::Identity(), at});
      pattern.instances.push_back(
          {{Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.5 * a, 0, 0)}, append(model.mesh, part)});
    }
    model.truth = whole(model.mesh, PointGroup::parse("C2v").value(), Eigen::Vector3d::Zero()).truth;
    model.truth.patterns.push_back(pattern);
    const Subspace subspace = subspace_of(model, mode, 0.06);
    const WorstResidual worst = worst_residual(model, subspace, random_state(subspace, 0.03));
    EXPECT_LT(worst.residual, 1e-12) << to_string(mode) << ": " << worst.name;
  }
}

// Turned in all ways at once in which its groups may turn, each by another angle, the model is as free as at rest.
void expect_agreeing_turns(const Subspace& subspace, const ConjugatedRegions& regions) {
  const Eigen::VectorXd angles =
      Eigen::VectorXd::NullaryExpr(regions.freedom(), [](Eigen::Index k) { return 0.2 + 0.1 * double(k); });
  EXPECT_TRUE(
      keeps_freedom(subspace, regions.rotations(regions.turned(regions.rest(), angles)), 1e-12 * subspace->diagonal));
}

// Blocks with a mirror each, in a row, grid, arc, stair or anyhow: what the pattern takes to one another turns alike.
TEST(PatternOfRegions, TurnAlike) {
  for (const Row& row : rows()) {
    SCOPED_TRACE(row.name);
    GeneratedModel model = model_of(row, box({0.15, 0.1, 0.12}, 3));
    for (const PatternInstance& instance : model.truth.patterns[0].instances) {
      const Motion& motion = instance.motion;
      model.truth.regions.push_back(make_region(PointGroup::parse("Cs").value(), motion.translation,
                                                frame_about(motion.linear.col(0)), instance.faces, "block"));
    }
    const Subspace subspace = subspace_of(model, GroupMode::moving, 0.05);
    const ConjugatedRegions regions(subspace);
    EXPECT_EQ(regions.freedom(), 3);
    expect_agreeing_turns(subspace, regions);
    const WorstResidual worst = worst_residual(model, subspace, random_state(subspace, 0.03));
    EXPECT_LT(worst.residual, 1e-12) << worst.name;
  }
}

// The steps of an arc stay as they are, so that the mirror of all of it cannot turn, however the handles ask for it.
TEST(PatternInARegion, AMirrorOfAnArcDoesNotTurn) {
  GeneratedModel model;
  const auto turn = [](int steps) { return Motion::rotation(Eigen::Vector3d::UnitX(), 0.35 * steps, {0, 1.3, 0}); };
  Pattern pattern;
  pattern.name = "arc";
  pattern.kind = Kind::rotation;
  pattern.generators = {turn(1)};
  for (int a = 0; a < 5; ++a) {
    pattern.instances.push_back({turn(a), append(model.mesh, placed(box({0.1, 0.08, 0.15}, 3), turn(a - 2)))});
  }
  model.truth = whole(model.mesh, PointGroup::parse("Cs").value(), Eigen::Vector3d::Zero()).truth;
  model.truth.patterns.push_back(pattern);
  const Subspace subspace = subspace_of(model, GroupMode::moving, 0.06);
  const ConjugatedRegions regions(subspace);
  EXPECT_LT(regions.freedom(), 3);  // about the mirror's normal it may
  expect_agreeing_turns(subspace, regions);
  const WorstResidual worst = worst_residual(model, subspace, random_state(subspace, 0.03));
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
}

}  // namespace
}  // namespace orbifit
