// Parts that touch at rest touch afterwards.

#include "deformation/contacts.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "deformation/contact_energy.h"
#include "deformation/touching_points.h"
#include "geometry/topology.h"
#include "parts.h"
#include "subspaces.h"

namespace orbifit {
namespace {

constexpr double kRadius = 0.05;  // of the diagonal

ContactOptions all_images() {
  ContactOptions options;
  options.representatives = false;
  return options;
}

Mesh two_boxes(double apart) {
  Mesh mesh = box({1, 1, 1}, 2);
  append(mesh, placed(box({0.5, 0.5, 0.5}, 2), {Eigen::Matrix3d::Identity(), {0.1, 0.05, 1.5 + apart}}));
  return mesh;
}

std::vector<TouchingPoints> touching_of(const Mesh& mesh, double tolerance) {
  const Components parts = touching_parts(mesh, weld_vertices(mesh.vertices));
  return touching_points(mesh, parts.component_of_face, tolerance, 0.2, RunContext{});
}

TEST(TouchingPoints, AreWhereSurfacesMeetOrComeNear) {
  EXPECT_TRUE(touching_of(two_boxes(0.02), 0.01).empty());
  const std::vector<TouchingPoints> near = touching_of(two_boxes(0.005), 0.01);
  ASSERT_FALSE(near.empty());
  for (const TouchingPoints& touching : near) {
    EXPECT_NEAR(touching.middle.z(), 1.0025, 1e-12);
    EXPECT_LT((touching.gap - Eigen::Vector3d(0, 0, -0.005)).norm(), 1e-12);
  }
}

// Also where the one face that is near is the mesh's first.
TEST(TouchingPoints, AreFoundOnASingleTriangle) {
  Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << -1, -1, 1.003, 1, -1, 1.003, 0, 1, 1.003;
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  append(mesh, box({0.2, 0.2, 1}, 2));
  const std::vector<TouchingPoints> touching = touching_of(mesh, 0.01);
  const auto of_vertex = [](const TouchingPoints& at) { return at.points[1].barycentric.maxCoeff() > 1 - 1e-12; };
  EXPECT_GT(std::ranges::count_if(touching, of_vertex), 3) << "corners of the box, on the triangle";
  for (const TouchingPoints& at : touching) EXPECT_EQ(at.points[0].face, 0);
}

// A box that goes through a face meets it along its own outline, wherever vertices are.
TEST(TouchingPoints, AreFoundWhereEdgesPierceFaces) {
  const std::vector<TouchingPoints> crossing = touching_of(two_boxes(-0.33), 1e-6);
  ASSERT_FALSE(crossing.empty());
  for (const TouchingPoints& touching : crossing) {
    EXPECT_LT(touching.gap.norm(), 1e-12);
    EXPECT_NEAR(touching.middle.z(), 1, 1e-12);
    EXPECT_NEAR(std::max(std::abs(touching.middle.x() - 0.1), std::abs(touching.middle.y() - 0.05)), 0.5, 1e-12);
  }
}

// With whatever spacings were asked for before.
TEST(TouchingSearch, FindsWhatIsFoundAnew) {
  const Mesh mesh = two_boxes(0.005);
  const Components parts = touching_parts(mesh, weld_vertices(mesh.vertices));
  const TouchingSearch search(mesh, parts.component_of_face, 0.01, RunContext{});
  for (const double spacing : {0.2, 0.21, 0.05, 0.2, 0.1}) {
    const std::vector<TouchingPoints> found = search.points(spacing, RunContext{});
    const std::vector<TouchingPoints> anew =
        touching_points(mesh, parts.component_of_face, 0.01, spacing, RunContext{});
    ASSERT_EQ(found.size(), anew.size()) << spacing;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].parts, anew[i].parts);
      EXPECT_EQ(found[i].middle, anew[i].middle);
      EXPECT_EQ(found[i].gap, anew[i].gap);
    }
  }
}

// The largest difference of what the two sides of a contact do, less the turn of its gap, of the diagonal.
double opened(const std::vector<Contact>& contacts, const Subspace& subspace, const SubspaceState& state) {
  const Points moved = vertex_displacements(subspace, state);
  double worst = 0;
  for (const Contact& contact : contacts) {
    Eigen::Vector3d difference = Eigen::Vector3d::Zero();
    for (const auto& [vertex, weight] : contact.sides[0].vertices) difference += weight * moved.row(vertex).transpose();
    for (const auto& [vertex, weight] : contact.sides[1].vertices) difference -= weight * moved.row(vertex).transpose();
    worst = std::max(worst, difference.norm());
  }
  return worst / subspace->diagonal;
}

struct Stool {
  explicit Stool(GroupMode mode)
      : model(generate("stool", {{"detail", 1}})),
        subspace(subspace_of(model, mode, kRadius)),
        contacts(find_contacts(subspace, model.mesh, all_images(), RunContext{})) {}

  Deformation splayed(bool with_contacts) const {
    const Mesh& mesh = model.mesh;
    DeformerOptions options;
    options.contacts = with_contacts;
    Deformer deformer(subspace, mesh, options);
    deformer.set_handles({handle_at(mesh, {0, 0, 0.46}, 0.19), handle_at(mesh, {0.18, 0, 0}, 0.045)}, 100);
    return deformer.solve({Motion{}, Motion{Eigen::Matrix3d::Identity(), {0.1, 0, 0}}}, 30);
  }

  GeneratedModel model;
  Subspace subspace;
  std::vector<Contact> contacts;
};

class SplayedStool : public testing::TestWithParam<GroupMode> {};

TEST_P(SplayedStool, KeepsItsContactsAndItsSymmetries) {
  const Stool stool(GetParam());
  const Deformation with = stool.splayed(true);
  const Deformation without = stool.splayed(false);
  EXPECT_LT(opened(stool.contacts, stool.subspace, with.state), 1e-3);
  EXPECT_GT(opened(stool.contacts, stool.subspace, without.state), 3e-3);
  // The edit is one: feet go out.
  const Points moved = vertex_displacements(stool.subspace, with.state);
  EXPECT_GT(moved.rowwise().norm().maxCoeff(), 0.01);
  const WorstResidual worst = worst_residual(stool.model, stool.subspace, with.state);
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
}

INSTANTIATE_TEST_SUITE_P(Modes, SplayedStool, testing::Values(GroupMode::floating, GroupMode::moving),
                         [](const auto& test) { return to_string(test.param); });

// Stretchers meet one another within the legs.
TEST(Contacts, JoinStretchersToLegsLegsToTheSeatAndStretchersToOneAnother) {
  const Stool stool(GroupMode::floating);
  EXPECT_EQ(stool.contacts.size(), 8U + 4U + 4U);
}

// As far as the triangles allow, which mirrors take to others.
TEST(Contacts, AreTakenToOneAnotherByTheGroups) {
  const Stool stool(GroupMode::floating);
  const Region& whole = stool.model.truth.regions.front();
  ASSERT_EQ(whole.elements.size(), 8U);
  for (const Motion& element : whole.elements) {
    for (const Contact& contact : stool.contacts) {
      const Eigen::Vector3d image = element(contact.point);
      EXPECT_TRUE(std::ranges::any_of(stool.contacts,
                                      [&](const Contact& other) { return (other.point - image).norm() < 1e-3; }));
    }
  }
}

// Rows of one contact of an orbit, counted for all, are the rows of all: the same system, hence the same edits.
TEST(Contacts, OneOfEachOrbitIsAsGoodAsAll) {
  for (const char* name : {"stool", "table", "chair"}) {
    const GeneratedModel model = generate(name, {{"detail", 1}});
    const Subspace subspace = subspace_of(model, GroupMode::floating, kRadius);
    const ContactEnergy some(find_contacts(subspace, model.mesh, {}, RunContext{}), subspace, 3);
    const ContactEnergy all(find_contacts(subspace, model.mesh, all_images(), RunContext{}), subspace, 3);
    EXPECT_LT(some.contacts().size(), all.contacts().size()) << name;
    const Eigen::MatrixXd gram_of_some = some.gram();
    const Eigen::MatrixXd gram_of_all = all.gram();
    EXPECT_GT(gram_of_all.norm(), 0) << name;
    EXPECT_LT((gram_of_some - gram_of_all).norm(), 1e-9 * gram_of_all.norm()) << name;
  }
}

TEST(Contacts, DoNotDependOnUnits) {
  const Stool stool(GroupMode::floating);
  const std::size_t orbits = find_contacts(stool.subspace, stool.model.mesh, {}, RunContext{}).size();
  for (const double scale : {1e-6, 0.01, 100.0, 1e6}) {
    GeneratedModel model = stool.model;
    model.mesh.vertices *= scale;
    model.truth = transformed(model.truth, {scale, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()});
    const Subspace subspace = subspace_of(model, GroupMode::floating, kRadius);
    const std::vector<Contact> contacts = find_contacts(subspace, model.mesh, all_images(), RunContext{});
    ASSERT_EQ(contacts.size(), stool.contacts.size()) << scale;
    EXPECT_EQ(find_contacts(subspace, model.mesh, {}, RunContext{}).size(), orbits) << scale;
    for (const Contact& contact : contacts) {
      EXPECT_TRUE(std::ranges::any_of(stool.contacts, [&](const Contact& other) {
        return (scale * other.point - contact.point).norm() < 1e-3 * scale;
      }));
    }
  }
}

TEST(Contacts, AreNotWhereNothingTouches) {
  const GeneratedModel model = generate("bar");
  const Subspace subspace = subspace_of(model, GroupMode::floating, kRadius);
  EXPECT_TRUE(find_contacts(subspace, model.mesh, {}, RunContext{}).empty());
  std::vector<Eigen::VectorXd> solutions;
  for (const bool contacts : {true, false}) {
    DeformerOptions options;
    options.contacts = contacts;
    Deformer deformer(subspace, model.mesh, options);
    deformer.set_handles({handle_at(model.mesh, {0, 0, 4}, 1.2), handle_at(model.mesh, {0, 0, -4}, 1.2)}, 100);
    solutions.push_back(deformer.solve({Motion{Eigen::Matrix3d::Identity(), {0.3, 0.1, 0.2}}, Motion{}}, 5).state.q);
  }
  EXPECT_EQ(solutions[0], solutions[1]);
}

TEST(Contacts, AreTheSameWithAnyNumberOfThreads) {
  const Stool stool(GroupMode::floating);
  RunContext two;
  two.threads = 2;
  RunContext one;
  one.threads = 1;
  const auto first = find_contacts(stool.subspace, stool.model.mesh, {}, one);
  const auto second = find_contacts(stool.subspace, stool.model.mesh, {}, two);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].point, second[i].point);
    EXPECT_EQ(first[i].sides[0].vertices, second[i].sides[0].vertices);
  }
}

// Two boxes with a narrow gap between their faces: it turns with them, whatever the direction.
TEST(Contacts, GapsTurnWithTheParts) {
  GeneratedModel model;
  model.mesh = two_boxes(0.01);
  model.truth = empty_annotation(model.mesh, 0.005);
  const Subspace subspace = subspace_of(model, GroupMode::fixed, 0.1);
  const ContactEnergy energy(find_contacts(subspace, model.mesh, {}, RunContext{}), subspace, 1);
  ASSERT_FALSE(energy.contacts().empty());
  const Eigen::Matrix3d turn = Random(3).rotation();
  for (const Contact& contact : energy.contacts()) {
    EXPECT_LT((turned_gap(contact, {turn, turn}) + contact.gap - turn * contact.gap).norm(), 1e-15);
  }
  // The linear part is the derivative of the value.
  Eigen::VectorXd q(subspace.degrees_of_freedom());
  Random random(8);
  for (double& coordinate : q) coordinate = 0.01 * random.normal();
  const auto turned = [&](int) { return turn; };
  const Eigen::MatrixXd gram = energy.gram();
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(q.size());
  energy.add_pull(turned, pull);
  const double at_rest = energy.value(Eigen::VectorXd::Zero(q.size()), turned);
  EXPECT_NEAR(energy.value(q, turned), q.dot(gram * q) - 2 * pull.dot(q) + at_rest, 1e-12);
  EXPECT_GT(at_rest, 1e-6);
}

}  // namespace
}  // namespace orbifit
