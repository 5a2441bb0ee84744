#include "orbifit/model/consistent_annotation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "geometry/vertex_grid.h"
#include "suite/detection_suite.h"
#include "support/parts.h"
#include "support/subspaces.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

// The truth of a model with every region's group moved a little, as a detector within a tolerance would have it.
SymmetryAnnotation perturbed(const GeneratedModel& model, double size) {
  Random random(6);
  SymmetryAnnotation result = model.truth;
  for (Region& region : result.regions) {
    const Motion frame{axis_rotation(random.direction(), size), size * 0.2 * random.direction()};
    for (Motion& element : region.elements) element = conjugate(frame, element);
    for (Motion& element : region.generators) element = conjugate(frame, element);
    region.centre = frame(region.centre);
    region.axis = frame.linear * region.axis;
  }
  return result;
}

// After two handles are dragged and turned, of all regions.
double worst_after_drag(const Mesh& mesh, const SymmetryAnnotation& annotation, GroupMode mode) {
  SubspaceOptions options;
  options.mode = mode;
  const Subspace subspace = build_subspace(mesh, annotation, options, RunContext{});
  const double size = subspace->diagonal;
  Eigen::Index low = 0;
  Eigen::Index high = 0;
  mesh.vertices.col(0).minCoeff(&low);
  mesh.vertices.rowwise().sum().maxCoeff(&high);
  const Vector3d there = mesh.vertices.row(high).transpose();
  Deformer deformer(subspace, mesh);
  deformer.set_handles(
      {handle_at(mesh, mesh.vertices.row(low).transpose(), 0.08 * size), handle_at(mesh, there, 0.08 * size)}, 100);
  const Motion drag = Motion{Eigen::Matrix3d::Identity(), 0.05 * size * Vector3d(1, -2, 1).normalized()} *
                      Motion::rotation(Vector3d(2, 1, 2).normalized(), 0.35, there);
  const Deformation deformation =
      deformer.solve({Motion{Eigen::Matrix3d::Identity(), 0.04 * size * Vector3d(-1, 1, 2).normalized()}, drag}, 5);
  EXPECT_GT(vertex_displacements(subspace, deformation.state).rowwise().norm().maxCoeff(), 1e-3 * size);
  double worst = 0;
  for (const Residual& each : field_residuals(subspace, mesh, annotation, deformation.state, RunContext{}, 500)) {
    worst = std::max(worst, each.max);
  }
  return worst;
}

void expect_exact(const Mesh& mesh, const SymmetryAnnotation& annotation) {
  for (const GroupMode mode : {GroupMode::fixed, GroupMode::floating, GroupMode::moving}) {
    EXPECT_LT(worst_after_drag(mesh, annotation, mode), 1e-12) << to_string(mode);
  }
}

std::string said(const ConsistentAnnotation& result) {
  std::string text;
  for (const LeftOut& each : result.left_out) text += to_string(each) + "\n";
  return text;
}

class NearlyConsistent : public testing::TestWithParam<const char*> {};

TEST_P(NearlyConsistent, AgreesSoThatNoRegionIsLost) {
  const GeneratedModel model = generate(GetParam());
  const ConsistentAnnotation result = consistent_annotation(model.mesh, perturbed(model, 5e-4), RunContext{});
  EXPECT_EQ(result.annotation.regions.size(), model.truth.regions.size()) << said(result);
  EXPECT_EQ(result.added, 0);
  EXPECT_EQ(result.largest_movement > 1e-6, model.truth.regions.size() > 1);  // one region agrees with itself
  EXPECT_LT(result.largest_movement, 2 * model.truth.tolerance);
  expect_exact(model.mesh, result.annotation);
}

INSTANTIATE_TEST_SUITE_P(Models, NearlyConsistent, testing::Values("bar", "table", "chair"));

class Consistent : public testing::TestWithParam<const char*> {};

TEST_P(Consistent, ComesBackAsItIs) {
  const GeneratedModel model = generate(GetParam());
  const ConsistentAnnotation once = consistent_annotation(model.mesh, model.truth, RunContext{});
  ASSERT_EQ(once.annotation.regions.size(), model.truth.regions.size()) << said(once);
  EXPECT_EQ(once.added, 0);
  EXPECT_LT(once.largest_movement, 1e-12);
  const ConsistentAnnotation twice = consistent_annotation(model.mesh, once.annotation, RunContext{});
  ASSERT_EQ(twice.annotation.regions.size(), once.annotation.regions.size());
  for (std::size_t i = 0; i < once.annotation.regions.size(); ++i) {
    EXPECT_EQ(twice.annotation.regions[i].centre, once.annotation.regions[i].centre);
    EXPECT_EQ(twice.annotation.regions[i].faces, once.annotation.regions[i].faces);
    EXPECT_EQ(once.annotation.regions[i].faces, model.truth.regions[i].faces);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Consistent, testing::Values("bar", "table", "chair", "armchair"));

// However much is left out, nothing is when what is left is made consistent anew.
class FarFromConsistent : public testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(FarFromConsistent, LosesAllThatItLosesAtOnce) {
  const GeneratedModel model = generate(std::get<0>(GetParam()));
  const ConsistentAnnotation once =
      consistent_annotation(model.mesh, perturbed(model, std::get<1>(GetParam())), RunContext{});
  const ConsistentAnnotation twice = consistent_annotation(model.mesh, once.annotation, RunContext{});
  EXPECT_TRUE(twice.left_out.empty()) << said(twice);
  EXPECT_EQ(twice.added, 0);
  EXPECT_EQ(twice.annotation.regions.size(), once.annotation.regions.size());
}

INSTANTIATE_TEST_SUITE_P(Models, FarFromConsistent,
                         testing::Combine(testing::Values("table", "chair", "armchair", "car", "wind_mill"),
                                          testing::Values(2e-3, 5e-3, 1e-2, 3e-2)));

std::vector<int> faces_between(const Mesh& mesh, double low, double high) {
  std::vector<int> result;
  for (int f = 0; f < static_cast<int>(mesh.faces.rows()); ++f) {
    double sum = 0;
    for (const int vertex : mesh.faces.row(f)) sum += mesh.vertices(vertex, 2);
    if (low < sum / 3 && sum / 3 < high) result.push_back(f);
  }
  return result;
}

// How far any vertex's displacement is from what a region that holds it makes of that of the vertex at its image.
double worst_at_vertices(const Mesh& mesh, const SymmetryAnnotation& annotation, const Points& displacements) {
  double worst = 0;
  const VertexGrid grid(mesh.vertices, 1e-9);
  for (const Region& region : annotation.regions) {
    for (const int v : vertices_of_faces(mesh, region.faces)) {
      for (const Motion& element : region.elements) {
        grid.visit(element(mesh.vertices.row(v).transpose()), [&](int image) {
          const Vector3d there = displacements.row(image).transpose();
          worst = std::max(worst, (there - element.linear * displacements.row(v).transpose()).norm());
        });
      }
    }
  }
  return worst;
}

// Of a box that is symmetric up and down, its ends and its belt, which lies off its middle: where the upper end goes
// beyond the image of the lower one, that image is the belt's.
TEST(ConsistentAnnotation, TakesBordersBackWhereVerticesCannotFollowBothSides) {
  GeneratedModel model = whole(box({0.5, 0.5, 1}, 16), {PointGroup::Family::Cs, 1}, Vector3d::Zero());
  const Mesh& mesh = model.mesh;
  const auto add = [&](const PointGroup& group, std::vector<int> faces) {
    model.truth.regions.push_back(
        make_region(group, Vector3d::Zero(), frame_about(Vector3d::UnitZ()), std::move(faces), group.symbol()));
    model.truth.regions.back().id = static_cast<int>(model.truth.regions.size()) - 1;
  };
  std::vector<int> ends = faces_between(mesh, -2, -0.5);
  const std::vector<int> upper = faces_between(mesh, 0.25, 2);
  ends.insert(ends.end(), upper.begin(), upper.end());
  std::ranges::sort(ends);
  add({PointGroup::Family::Cnv, 4}, ends);
  add({PointGroup::Family::Cnv, 2}, faces_between(mesh, -0.5, 0.25));
  const ConsistentAnnotation result = consistent_annotation(mesh, model.truth, RunContext{});
  ASSERT_EQ(result.annotation.regions.size(), 3U) << said(result);
  EXPECT_EQ(result.annotation.regions[2].faces, model.truth.regions[2].faces);
  std::vector<int> outside = faces_between(mesh, -2, -0.5);
  const std::vector<int> top = faces_between(mesh, 0.5, 2);
  outside.insert(outside.end(), top.begin(), top.end());
  std::ranges::sort(outside);
  EXPECT_EQ(result.annotation.regions[1].faces, outside);
  SubspaceOptions options;
  options.mode = GroupMode::fixed;
  const Subspace subspace = build_subspace(mesh, result.annotation, options, RunContext{});
  const Points displacements = vertex_displacements(subspace, random_state(subspace, 0.05));
  EXPECT_GT(displacements.rowwise().norm().maxCoeff(), 1e-2);
  EXPECT_LT(worst_at_vertices(mesh, result.annotation, displacements), 1e-12);
}

TEST(ConsistentAnnotation, LeavesOutARegionThatClashesAndSaysSo) {
  const GeneratedModel model = generate("table");
  SymmetryAnnotation annotation = model.truth;
  Region clash = make_region(PointGroup{PointGroup::Family::Cs, 1}, {0.2, 0, 0}, frame_about(Vector3d::UnitX()),
                             annotation.regions[1].faces, "clash");
  clash.id = 99;
  annotation.regions.push_back(clash);
  const ConsistentAnnotation result = consistent_annotation(model.mesh, annotation, RunContext{});
  EXPECT_EQ(result.annotation.regions.size(), model.truth.regions.size());
  ASSERT_EQ(result.left_out.size(), 1U);
  EXPECT_EQ(result.left_out.front().id, 99);
  EXPECT_NE(to_string(result.left_out.front()).find("clash"), std::string::npos);
}

TEST(ConsistentAnnotation, AddsAnImageThatIsMissing) {
  const GeneratedModel model = generate("table");
  SymmetryAnnotation annotation = model.truth;
  // The last region has images under the whole's group: one of them goes.
  const Region gone = annotation.regions.back();
  const auto alike = std::ranges::count_if(annotation.regions, [&](const Region& region) {
    return region.group == gone.group && region.faces.size() == gone.faces.size();
  });
  ASSERT_GT(alike, 1);
  annotation.regions.pop_back();
  const ConsistentAnnotation result = consistent_annotation(model.mesh, annotation, RunContext{});
  EXPECT_EQ(result.added, 1);
  EXPECT_EQ(result.annotation.regions.size(), model.truth.regions.size()) << said(result);
  const Region& image = result.annotation.regions.back();
  EXPECT_EQ(image.faces, gone.faces);
  EXPECT_LT((image.centre - gone.centre).norm(), 1e-9);
}

// A disc about z with n lobes and one side higher than the other: Cnv, and no more.
Mesh lobed(int n, double radius) {
  const int around = 8 * n;
  Mesh mesh;
  mesh.vertices.resize(2 * around + 2, 3);
  for (int k = 0; k < around; ++k) {
    const double angle = 2 * std::numbers::pi * k / around;
    const double r = radius * (1 + 0.2 * std::cos(n * angle));
    mesh.vertices.row(k) << r * std::cos(angle), r * std::sin(angle), 0;
    mesh.vertices.row(around + k) << 0.7 * r * std::cos(angle), 0.7 * r * std::sin(angle), 0.4 * radius;
  }
  mesh.vertices.row(2 * around) << 0, 0, 0;
  mesh.vertices.row(2 * around + 1) << 0, 0, 0.4 * radius;
  mesh.faces.resize(4 * around, 3);
  for (int k = 0; k < around; ++k) {
    const int next = (k + 1) % around;
    mesh.faces.row(4 * k) << k, next, around + k;
    mesh.faces.row(4 * k + 1) << next, around + next, around + k;
    mesh.faces.row(4 * k + 2) << next, k, 2 * around;
    mesh.faces.row(4 * k + 3) << around + k, around + next, 2 * around + 1;
  }
  return mesh;
}

// A box about the origin, its sides cut into squares.
Mesh body(const Vector3d& half, int cuts) {
  Mesh mesh;
  std::vector<Vector3d> points;
  std::vector<std::array<int, 3>> faces;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? 1 : -1;
    const int first = static_cast<int>(points.size());
    for (int i = 0; i <= cuts; ++i) {
      for (int j = 0; j <= cuts; ++j) {
        Vector3d point;
        point[axis] = sign * half[axis];
        point[(axis + 1) % 3] = half[(axis + 1) % 3] * (2.0 * i / cuts - 1);
        point[(axis + 2) % 3] = half[(axis + 2) % 3] * (2.0 * j / cuts - 1);
        points.push_back(point);
      }
    }
    for (int i = 0; i < cuts; ++i) {
      for (int j = 0; j < cuts; ++j) {
        const int a = first + i * (cuts + 1) + j;
        const int b = a + cuts + 1;
        // Diagonals run towards the middle, so that mirrors map triangles onto triangles.
        const bool rising = (2 * i < cuts) == (2 * j < cuts);
        if (rising) {
          faces.push_back({a, b, b + 1});
          faces.push_back({a, b + 1, a + 1});
        } else {
          faces.push_back({a, b, a + 1});
          faces.push_back({b, b + 1, a + 1});
        }
      }
    }
  }
  mesh.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.vertices.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (int k = 0; k < 3; ++k) mesh.faces(static_cast<Eigen::Index>(i), k) = faces[i][static_cast<std::size_t>(k)];
  }
  return mesh;
}

// Appends the part as `motion` moves it; returns its faces.
std::vector<int> append(Mesh& mesh, const Mesh& part, const Motion& motion) {
  const Eigen::Index vertices = mesh.vertices.rows();
  const Eigen::Index faces = mesh.faces.rows();
  mesh.vertices.conservativeResize(vertices + part.vertices.rows(), 3);
  mesh.faces.conservativeResize(faces + part.faces.rows(), 3);
  for (Eigen::Index v = 0; v < part.vertices.rows(); ++v) {
    mesh.vertices.row(vertices + v) = motion(part.vertices.row(v).transpose()).transpose();
  }
  mesh.faces.bottomRows(part.faces.rows()) = part.faces.array() + static_cast<int>(vertices);
  std::vector<int> result;
  for (Eigen::Index f = 0; f < part.faces.rows(); ++f) result.push_back(static_cast<int>(faces + f));
  return result;
}

std::vector<int> all_faces(const Mesh& mesh) {
  std::vector<int> result(static_cast<std::size_t>(mesh.faces.rows()));
  for (std::size_t f = 0; f < result.size(); ++f) result[f] = static_cast<int>(f);
  return result;
}

// A car: the whole has the mirror across x; four wheels (C5v) with axes +x and -x are a pattern whose motions include
// reflections; hub caps (Cinfv) on their axes.
// Two round posts whose axes were found one by one, each within positions as they are told, and their heads as copies:
// the copies' motion is made to take the one's axis to the other's.
TEST(ConsistentAnnotation, CopiesOnRoundPostsKeepTheirAxes) {
  std::vector<double> angles;
  for (int k = 0; k < 24; ++k) angles.push_back(2 * std::numbers::pi * k / 24);
  const Mesh post = turned_part({{0, 0}, {0.2, 0}, {0.2, 1}, {0.3, 1.1}, {0.25, 1.3}, {0, 1.35}}, angles);
  Mesh mesh;
  SymmetryAnnotation annotation;
  Pattern heads;
  heads.kind = Pattern::Kind::congruent;
  const Motion step{Eigen::Matrix3d::Identity(), Vector3d(1.5, 0, 0)};
  std::vector<Region> posts;
  for (const Motion& place : {Motion{}, step}) {
    const Motion tilted =
        place * Motion::rotation(Vector3d::UnitY(), place.translation.x() > 0 ? 4e-7 : 0, Vector3d::Zero());
    const std::vector<int> faces = append(mesh, post, place);
    posts.push_back(make_region(*PointGroup::parse("Cinfv"), place(Vector3d::Zero()), frame_about(tilted.linear.col(2)),
                                faces, "post"));
    std::vector<int> head;
    for (const int face : faces) {
      if (mesh.vertices(mesh.faces(face, 0), 2) > 0.99 && mesh.vertices(mesh.faces(face, 1), 2) > 0.99 &&
          mesh.vertices(mesh.faces(face, 2), 2) > 0.99) {
        head.push_back(face);
      }
    }
    heads.instances.push_back({place, head});
  }
  annotation = empty_annotation(mesh, 0.005);
  annotation.regions = posts;
  annotation.regions[1].id = 1;
  annotation.patterns = {heads};
  const ConsistentAnnotation result = consistent_annotation(mesh, annotation, RunContext{});
  EXPECT_TRUE(result.left_out.empty()) << said(result);
  expect_exact(mesh, result.annotation);
}

// Four cones that stand on the mirrors of a square: the motion from one to another is known but for the mirror through
// it, of which no region of its own need tell.
class CopiesOnMirrors : public testing::TestWithParam<int> {};

TEST_P(CopiesOnMirrors, ComeBackAsTheyAre) {
  std::vector<double> angles;
  for (int k = 0; k < 8; ++k) angles.push_back(2 * std::numbers::pi * k / 8);
  const Mesh cone = turned_part({{0, 0}, {0.2, 0}, {0, 1}}, angles);
  Mesh mesh;
  Pattern cones;
  cones.kind = Pattern::Kind::congruent;
  const Motion there{Eigen::Matrix3d::Identity(), Vector3d(1, 0, 0)};
  for (int k = 0; k < 4; ++k) {
    const Motion turn = Motion::rotation(Vector3d::UnitZ(), k * std::numbers::pi / 2, Vector3d::Zero());
    cones.instances.push_back({turn, append(mesh, cone, turn * there)});
    const Motion mirror = Motion::about(
        Eigen::Matrix3d::Identity() - 2 * Vector3d::UnitY() * Vector3d::UnitY().transpose(), Vector3d::Zero());
    if ((GetParam() >> k & 1) != 0) cones.instances.back().motion = turn * mirror;
  }
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  annotation.regions = {
      make_region(*PointGroup::parse("C4v"), Vector3d::Zero(), GroupFrame::Identity(), all_faces(mesh), "whole")};
  annotation.patterns = {cones};
  const ConsistentAnnotation result = consistent_annotation(mesh, annotation, RunContext{});
  EXPECT_TRUE(result.left_out.empty()) << said(result);
  ASSERT_EQ(result.annotation.patterns.size(), 1U);
  for (std::size_t t = 0; t < 4; ++t) {
    EXPECT_EQ(result.annotation.patterns[0].instances[t].motion.linear, cones.instances[t].motion.linear) << t;
  }
  expect_exact(mesh, result.annotation);
}

// By bit: of which copies the motion has the mirror as well. Never of the first, to which it is the identity.
INSTANTIATE_TEST_SUITE_P(Each, CopiesOnMirrors, testing::Values(0, 2, 4, 10, 14));

// Blades that turn about a hub, and arms that mirrors of the hub keep: neither takes the other along, and on the hub a
// group that holds both says all.
struct Overlap {
  const char* turning;    // group of hub and blades, about z
  const char* mirroring;  // of hub and arms
  const char* hub;
  int blades, arms;
};

void PrintTo(const Overlap& overlap, std::ostream* to) {
  *to << overlap.turning << " and " << overlap.mirroring << " on " << overlap.hub;
}

class OverlappingGroups : public testing::TestWithParam<Overlap> {
 protected:
  OverlappingGroups() {
    const Overlap& overlap = GetParam();
    const std::string hub = overlap.hub;
    const Mesh round = turned_part({{0, -0.1}, {0.3, -0.1}, {0.3, 0.1}, {0.2, 0.15}, {0, 0.15}}, irregular_angles(23));
    common_ = append(mesh_, hub == "Cinfv" ? round : hub == "C5v" ? lobed(5, 0.3) : body({0.3, 0.3, 0.1}, 4), {});
    turning_ = mirroring_ = common_;
    const auto add = [&](std::vector<int>& faces, const Mesh& part, double angle, const Motion& way) {
      const Motion turn = Motion::rotation(Vector3d::UnitZ(), angle, Vector3d::Zero());
      const std::vector<int> added = append(mesh_, part, turn * way);
      faces.insert(faces.end(), added.begin(), added.end());
    };
    const Motion inclined = Motion{Eigen::Matrix3d::Identity(), Vector3d(0.7, 0, 0)} *
                            Motion::rotation(Vector3d(2, 1, 0).normalized(), 0.5, Vector3d::Zero());
    for (int k = 0; k < overlap.blades; ++k) {
      add(turning_, body({0.2, 0.08, 0.02}, 2), (k + 0.3) * 2 * std::numbers::pi / overlap.blades, inclined);
    }
    for (int k = 0; k < overlap.arms; ++k) {
      const Motion out{Eigen::Matrix3d::Identity(), Vector3d(0.8, 0, 0)};
      add(mirroring_, body({0.3, 0.05, 0.04}, 4), k * 2 * std::numbers::pi / overlap.arms, out);
    }
    annotation_ = empty_annotation(mesh_, 0.005);
    const bool level = std::string(overlap.mirroring) == "Cs";
    declare(overlap.turning, Vector3d::UnitZ(), turning_);
    declare(overlap.mirroring, level ? Vector3d::UnitY() : Vector3d::UnitZ(), mirroring_);
    declare(overlap.hub, Vector3d::UnitZ(), common_);
    set_parents(annotation_.regions);
  }

  void declare(const char* group, const Vector3d& axis, const std::vector<int>& faces) {
    Eigen::Matrix3d frame = axis_rotation(Vector3d::UnitZ(), std::numbers::pi / 2);  // a mirror of Cnv holds the x axis
    if (axis != Vector3d::UnitZ()) frame = frame_about(axis);
    annotation_.regions.push_back(make_region(*PointGroup::parse(group), Vector3d::Zero(), frame, faces, group));
    annotation_.regions.back().id = static_cast<int>(annotation_.regions.size()) - 1;
  }

  Mesh mesh_;
  std::vector<int> common_, turning_, mirroring_;
  SymmetryAnnotation annotation_;
};

TEST_P(OverlappingGroups, KeepAllFacesAndAreExact) {
  for (const double size : {0.0, 5e-4}) {
    SCOPED_TRACE(size);
    const ConsistentAnnotation result =
        consistent_annotation(mesh_, perturbed({mesh_, annotation_}, size), RunContext{});
    ASSERT_EQ(result.annotation.regions.size(), 3U) << said(result);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(result.annotation.regions[i].faces, annotation_.regions[i].faces) << i;
    }
    EXPECT_EQ(result.added, 0);
    expect_exact(mesh_, result.annotation);
    const ConsistentAnnotation again = consistent_annotation(mesh_, result.annotation, RunContext{});
    EXPECT_EQ(again.largest_movement, 0);
  }
}

TEST_P(OverlappingGroups, NeedTheLargerGroupWhereTheyMeet) {
  annotation_.regions.pop_back();
  const ConsistentAnnotation result = consistent_annotation(mesh_, annotation_, RunContext{});
  std::size_t faces = 0;
  for (const Region& region : result.annotation.regions) faces += region.faces.size();
  EXPECT_LT(faces, turning_.size() + mirroring_.size());
  expect_exact(mesh_, result.annotation);
}

INSTANTIATE_TEST_SUITE_P(Groups, OverlappingGroups,
                         testing::Values(Overlap{"C5", "Cs", "Cinfv", 5, 1}, Overlap{"C5", "Cs", "C5v", 5, 1},
                                         Overlap{"C4", "Cs", "D4h", 4, 1}, Overlap{"C3", "C2v", "Cinfv", 3, 2}),
                         [](const auto& tested) {
                           return std::string(tested.param.hub) + "Hub" + std::to_string(tested.param.blades) +
                                  "Blades";
                         });

// Truths of the detection suite in which patterns and groups overlap: twenty windows of which a mirror of the wall
// keeps sixteen, and a chain whose links turn by a quarter, where the whole's group takes steps to steps of the other
// hand.
class OverlappingPattern : public testing::TestWithParam<const char*> {};

TEST_P(OverlappingPattern, IsKeptBesideTheGroupsAroundIt) {
  const std::vector<SuiteModel> suite = detection_suite();
  const auto found = std::ranges::find(suite, GetParam(), &SuiteModel::name);
  ASSERT_NE(found, suite.end());
  const TruthModel model = found->build();
  SymmetryAnnotation annotation = model.truth.expected;
  annotation.regions.resize(1);  // the largest; those about single links of the chain need images that it lacks
  const ConsistentAnnotation result = consistent_annotation(model.mesh, annotation, RunContext{});
  EXPECT_TRUE(result.left_out.empty()) << said(result);
  EXPECT_EQ(result.annotation.regions.size(), 1U);
  EXPECT_EQ(result.annotation.patterns.size(), 1U);
  expect_exact(model.mesh, result.annotation);
}

INSTANTIATE_TEST_SUITE_P(Models, OverlappingPattern, testing::Values("facade", "chain"));

Motion shifted(const Vector3d& way) {
  return {Eigen::Matrix3d::Identity(), way};
}

Pattern row(const Motion& step, std::size_t count) {
  Pattern result;
  result.name = "row";
  result.kind = step.linear.isIdentity() ? Pattern::Kind::translation_1d : Pattern::Kind::rotation;
  result.generators = {step};
  Motion motion;
  for (std::size_t k = 0; k < count; ++k) {
    result.instances.push_back({motion, {}});
    motion = step * motion;
  }
  return result;
}

// Five pieces of one bar, each ending where the next begins: there the pieces give up a strip, and so they do at the
// bar's ends, where it has its images.
TEST(ConsistentAnnotation, CopiesThatTouchGiveUpWhereTheyDo) {
  constexpr int kCells = 40;
  const Mesh mesh = box({2.5, 0.5, 0.5}, kCells);
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  annotation.patterns = {row(shifted({1, 0, 0}), 5)};
  const auto cells = [&](double low, double high) {
    std::vector<int> result;
    for (int f = 0; f < static_cast<int>(mesh.faces.rows()); ++f) {
      const Eigen::VectorXd x = mesh.vertices(Eigen::VectorXi(mesh.faces.row(f)), 0);
      if (x.minCoeff() > low - 1e-9 && x.maxCoeff() < high + 1e-9 && x.minCoeff() < x.maxCoeff()) result.push_back(f);
    }
    return result;
  };
  for (int k = 0; k < 5; ++k) {
    annotation.patterns[0].instances[static_cast<std::size_t>(k)].faces = cells(k - 2.5, k - 1.5);
  }
  const ConsistentAnnotation result = consistent_annotation(mesh, annotation, RunContext{});
  ASSERT_TRUE(result.left_out.empty()) << said(result);
  for (int k = 0; k < 5; ++k) {
    const double strip = 5.0 / kCells;
    EXPECT_EQ(result.annotation.patterns[0].instances[static_cast<std::size_t>(k)].faces,
              cells(k - 2.5 + strip, k - 1.5 - strip));
  }
  expect_exact(mesh, result.annotation);
}

// Seats around half a circle, below a mirror: what a detector's step climbs is its error, which no turn takes away.
TEST(ConsistentAnnotation, RotationsDoNotClimb) {
  Mesh mesh;
  const Motion step = Motion::rotation(Vector3d::UnitZ(), std::numbers::pi / 7, Vector3d::Zero());
  SymmetryAnnotation annotation;
  Pattern seats = row(Motion{step.linear, {0, 0, 1e-3}}, 8);
  Motion place{Eigen::Matrix3d::Identity(), {3, 0, 0}};
  for (PatternInstance& seat : seats.instances) {
    seat.faces = append(mesh, box({0.2, 0.3, 0.4}, 3), place);
    place = step * place;
  }
  annotation = empty_annotation(mesh, 0.005);
  annotation.regions = {make_region(*PointGroup::parse("Cs"), Vector3d::Zero(), frame_about(Vector3d::UnitX()),
                                    all_faces(mesh), "whole")};
  annotation.patterns = {seats};
  const ConsistentAnnotation result = consistent_annotation(mesh, annotation, RunContext{});
  ASSERT_TRUE(result.left_out.empty()) << said(result);
  const Motion& fitted = result.annotation.patterns[0].generators[0];
  EXPECT_LT(std::abs(fitted.translation.z()), 1e-12);
  expect_exact(mesh, result.annotation);
}

struct Car {
  Mesh mesh;
  SymmetryAnnotation annotation;

  Car() {
    append(mesh, body({0.6, 1.6, 0.4}, 8), Motion{Eigen::Matrix3d::Identity(), {0, 0.1, 0.6}});
    const Mesh wheel = lobed(5, 0.35);
    const Motion upright = Motion::rotation(Vector3d::UnitY(), std::numbers::pi / 2, Vector3d::Zero());
    const Motion mirror = Motion::reflection(Vector3d::UnitX(), Vector3d::Zero());
    std::vector<Motion> places;
    for (const double y : {1.1, -1.0}) {
      const Motion right = Motion{Eigen::Matrix3d::Identity(), {0.75, y, 0.35}} * upright;
      places.push_back(right);
      places.push_back(mirror * right);
    }
    std::vector<Region> wheels;
    Pattern pattern;
    pattern.name = "wheels";
    pattern.kind = Pattern::Kind::congruent;
    for (const Motion& place : places) {
      const std::vector<int> faces = append(mesh, wheel, place);
      GroupFrame frame = place.linear;
      if (frame.determinant() < 0) frame.col(1) = -frame.col(1);
      wheels.push_back(make_region(*PointGroup::parse("C5v"), place.translation, frame, faces, "wheel"));
      pattern.instances.push_back({place * inverse(places.front()), faces});
    }
    pattern.instances.front().motion = Motion{};
    annotation = empty_annotation(mesh, 0.005);
    annotation.regions.push_back(make_region(*PointGroup::parse("Cs"), Vector3d::Zero(), frame_about(Vector3d::UnitX()),
                                             all_faces(mesh), "whole"));
    annotation.regions.insert(annotation.regions.end(), wheels.begin(), wheels.end());
    for (std::size_t i = 0; i < annotation.regions.size(); ++i) annotation.regions[i].id = static_cast<int>(i);
    set_parents(annotation.regions);
    annotation.patterns.push_back(pattern);
  }
};

TEST(ConsistentAnnotation, WheelsOfACarAreAPatternWithReflections) {
  const Car car;
  const ConsistentAnnotation result = consistent_annotation(car.mesh, car.annotation, RunContext{});
  EXPECT_TRUE(result.left_out.empty()) << said(result);
  EXPECT_EQ(result.annotation.patterns.size(), 1U);
  expect_exact(car.mesh, result.annotation);
}

TEST(ConsistentAnnotation, WheelsOfADetectedCarAgreeAllTheSame) {
  // As above, with every group and motion a little off.
  Car car;
  Random random(3);
  const auto nudge = [&](double size) {
    return Motion{axis_rotation(random.direction(), size), size * random.direction()};
  };
  for (Region& region : car.annotation.regions) {
    const Motion by = nudge(2e-4);
    GroupFrame frame = frame_about(region.axis);
    if (region.group.order() > 2) {
      std::vector<Eigen::Matrix3d> linear;
      for (const Motion& element : region.elements) linear.push_back(element.linear);
      frame = classify(linear)->frame;
    }
    Region moved = make_region(region.group, by(region.centre), by.linear * frame, region.faces, region.name);
    moved.id = region.id;
    region = moved;
  }
  for (std::size_t t = 1; t < car.annotation.patterns.front().instances.size(); ++t) {
    Motion& motion = car.annotation.patterns.front().instances[t].motion;
    motion = nudge(2e-4) * motion;
  }
  const ConsistentAnnotation result = consistent_annotation(car.mesh, car.annotation, RunContext{});
  EXPECT_TRUE(result.left_out.empty()) << said(result);
  EXPECT_GT(result.largest_movement, 1e-6);
  expect_exact(car.mesh, result.annotation);
}

// A detector draws the border of a region and of a pattern's instance one by one: one face of 432 is no difference.
TEST(ConsistentAnnotation, ARegionAndAnInstanceThatAreTheSameButForASliverBecomeTheSame) {
  GeneratedModel model;
  Pattern pattern;
  pattern.name = "row";
  pattern.kind = Pattern::Kind::translation_1d;
  pattern.generators = {{Eigen::Matrix3d::Identity(), Vector3d(0.5, 0, 0)}};
  for (int a = 0; a < 3; ++a) {
    const Motion step{Eigen::Matrix3d::Identity(), Vector3d(0.5 * a, 0.0, 0.0)};
    pattern.instances.push_back({step, append(model.mesh, placed(box({0.15, 0.1, 0.12}, 6), step))});
  }
  model.truth = empty_annotation(model.mesh, 0.005);
  for (int a = 0; a < 3; ++a) {
    const PatternInstance& instance = pattern.instances[static_cast<std::size_t>(a)];
    std::vector<int> faces = instance.faces;
    if (a == 1) faces.erase(faces.begin());
    model.truth.regions.push_back(make_region(PointGroup::parse("Cs").value(), instance.motion.translation,
                                              frame_about(Vector3d::UnitZ()), faces, "box " + std::to_string(a)));
    model.truth.regions.back().id = a;
  }
  model.truth.patterns = {pattern};
  const ConsistentAnnotation result = consistent_annotation(model.mesh, model.truth, RunContext{});
  EXPECT_TRUE(result.left_out.empty());
  EXPECT_EQ(result.annotation.regions.size(), 3U);
  ASSERT_EQ(result.annotation.patterns.size(), 1U);
  EXPECT_EQ(result.annotation.patterns[0].instances[1].faces, result.annotation.regions[1].faces);
  expect_exact(model.mesh, result.annotation);
}

// In the y-z plane: |y| <= half, 0 <= z <= 0.3, of cells x cells squares.
Mesh grid_plate(double half, int cells) {
  Mesh mesh;
  mesh.vertices.resize((cells + 1) * (cells + 1), 3);
  mesh.faces.resize(2 * cells * cells, 3);
  int face = 0;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      const int here = i * (cells + 1) + j;
      mesh.vertices.row(here) << 0, half * (2.0 * i / cells - 1), 0.3 * j / cells;
      if (i == cells || j == cells) continue;
      mesh.faces.row(face++) << here, here + cells + 1, here + cells + 2;
      mesh.faces.row(face++) << here, here + cells + 2, here + 1;
    }
  }
  return mesh;
}

// Parts beside a wheel, each of which shares a mirror with it: the wheel's group holds all mirrors, at any angle. On
// the wheel alone: where two parts meet beside it, the product of their mirrors goes all around.
struct BesideAWheel {
  double angle;  // between the two, radians
  bool touch;    // in an edge
};

void PrintTo(const BesideAWheel& parts, std::ostream* to) {
  *to << parts.angle << (parts.touch ? ", touching" : "");
}

class MirrorsThroughAWheel : public testing::TestWithParam<BesideAWheel> {};

TEST_P(MirrorsThroughAWheel, AreKeptAtAnyAngle) {
  const auto [angle, touch] = GetParam();
  Mesh mesh;
  const std::vector<int> wheel = append(mesh, turned_part({{0, 0}, {1, 0}, {1, 0.3}, {0, 0.3}}, irregular_angles(40)));
  std::vector<Region> regions{make_region(PointGroup::parse("Cinfv").value(), Vector3d::Zero(),
                                          frame_about(Vector3d::UnitZ()), wheel, "wheel")};
  const double half = touch ? 1.4 * std::tan(angle / 2) : 0.05;
  const Mesh plate = grid_plate(half, 6);
  for (const double turn : {0.0, angle}) {
    const Motion about = Motion::rotation(Vector3d::UnitZ(), turn, Vector3d::Zero());
    std::vector<int> faces = append(mesh, placed(plate, about * Motion{Eigen::Matrix3d::Identity(), {1.4, 0, 0}}));
    faces.insert(faces.begin(), wheel.begin(), wheel.end());
    regions.push_back(make_region(PointGroup::parse("Cs").value(), Vector3d::Zero(),
                                  frame_about(about.linear * Vector3d::UnitY()), faces, "wheel and plate"));
    regions.back().id = static_cast<int>(regions.size()) - 1;
  }
  SymmetryAnnotation annotation = empty_annotation(mesh, 1e-3);
  annotation.regions = regions;
  set_parents(annotation.regions);
  const ConsistentAnnotation result = consistent_annotation(mesh, annotation, RunContext{});
  EXPECT_EQ(result.annotation.regions.size(), 3U) << said(result);
  expect_exact(mesh, result.annotation);
}

INSTANTIATE_TEST_SUITE_P(Angles, MirrorsThroughAWheel,
                         testing::Values(BesideAWheel{std::numbers::pi / 3, false}, BesideAWheel{0.7, false},
                                         BesideAWheel{1.3, false}, BesideAWheel{std::numbers::pi / 3, true},
                                         BesideAWheel{0.7, true}, BesideAWheel{1.3, true}));

// Two groups of a cube, which only a larger one holds both: the one of more elements stays, but for one that most of
// the surface has not.
TEST(ConsistentAnnotation, RegionsBeyondTheToleranceGiveWay) {
  for (const double residual : {0.0, 0.02}) {
    Mesh mesh;
    const std::vector<int> cube = append(mesh, box(Vector3d::Constant(0.5), 6));
    append(mesh, placed(wedge(1.5), {Eigen::Matrix3d::Identity(), Vector3d(4, 0, 0)}));
    SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
    annotation.regions = {
        make_region(PointGroup::parse("C2v").value(), Vector3d::Zero(), frame_about(Vector3d::UnitZ()), cube, "few"),
        make_region(PointGroup::parse("C4v").value(), Vector3d::Zero(), frame_about(Vector3d::UnitX()), cube, "many")};
    annotation.regions[1].id = 1;
    annotation.regions[1].residual.max = residual;
    set_parents(annotation.regions);
    const ConsistentAnnotation result = consistent_annotation(mesh, annotation, RunContext{});
    ASSERT_EQ(result.annotation.regions.size(), 1U) << residual;
    EXPECT_EQ(result.annotation.regions.front().name, residual > 0 ? "few" : "many");
  }
}

// Blocks in a row, of which the last was broken: the row's mirror leaves it and its image out. It could not keep the
// first block's group else, of which it has no image, nor then the others'.
TEST(ConsistentAnnotation, ARegionLeavesOutWhatHasLostItsImage) {
  constexpr int kPairs = 3;
  const Mesh block = body({0.3, 0.3, 0.5}, 4);  // whose triangles its mirrors take to one another
  const auto middle = [](const Mesh& of, Eigen::Index face) {
    double sum = 0;
    for (const int vertex : of.faces.row(face)) sum += of.vertices(vertex, 0);
    return sum / 3;
  };
  Mesh mesh;
  std::vector<int> row;  // what the mirror keeps
  std::vector<std::vector<int>> blocks;
  SymmetryAnnotation annotation;
  for (int k = -kPairs; k <= kPairs; ++k) {
    if (k == 0) continue;
    Mesh part = placed(block, {Eigen::Matrix3d::Identity(), Vector3d(k, 0, 0)});
    std::vector<Eigen::Index> left;
    for (Eigen::Index f = 0; f < part.faces.rows(); ++f) {
      if (k < kPairs || middle(part, f) < kPairs) left.push_back(f);
    }
    part.faces = Triangles(part.faces(left, Eigen::all));
    blocks.push_back(append(mesh, part));
    for (const int face : blocks.back()) {
      if (k > -kPairs || middle(mesh, face) > -kPairs) row.push_back(face);
    }
    if (k == kPairs) continue;
    annotation.regions.push_back(make_region(PointGroup::parse("D4h").value(), {static_cast<double>(k), 0, 0},
                                             frame_about(Vector3d::UnitZ()), blocks.back(), "block"));
  }
  annotation.regions.push_back(
      make_region(PointGroup::parse("Cs").value(), Vector3d::Zero(), frame_about(Vector3d::UnitX()), row, "row"));
  SymmetryAnnotation given = empty_annotation(mesh, 0.005);
  given.regions = annotation.regions;
  for (std::size_t i = 0; i < given.regions.size(); ++i) given.regions[i].id = static_cast<int>(i);
  set_parents(given.regions);
  const ConsistentAnnotation result = consistent_annotation(mesh, given, RunContext{});
  ASSERT_EQ(result.annotation.regions.size(), given.regions.size()) << said(result);
  std::vector<int> inner;
  for (std::size_t i = 1; i + 1 < blocks.size(); ++i) inner.insert(inner.end(), blocks[i].begin(), blocks[i].end());
  for (const Region& region : result.annotation.regions) {
    if (region.name == "row") {
      EXPECT_EQ(region.faces, inner);
    } else {
      EXPECT_EQ(region.faces.size(), static_cast<std::size_t>(block.faces.rows()));
    }
  }
  expect_exact(mesh, result.annotation);
}

// Wheels of one axle that nothing else relates, each with a lug: they lie on nearly one line, and each turns about its
// own, or its mirror would not keep it.
TEST(ConsistentAnnotation, WheelsOfOneAxleTurnEachAboutItsOwn) {
  Mesh mesh;
  SymmetryAnnotation annotation;
  for (const double along : {-1.0, 1.0}) {
    const Motion place = Motion{axis_rotation(Vector3d::UnitX(), 2e-8 * along), Vector3d(2e-8 * along, 0, along)};
    const Motion beside{Eigen::Matrix3d::Identity(), Vector3d(1.4, 0, 0)};
    const std::vector<int> wheel =
        append(mesh, placed(turned_part({{0, 0}, {1, 0}, {1, 0.3}, {0, 0.3}}, irregular_angles(40)), place));
    std::vector<int> both = append(mesh, placed(grid_plate(0.05, 6), place * beside));
    both.insert(both.begin(), wheel.begin(), wheel.end());
    annotation.regions.push_back(make_region(PointGroup::parse("Cinfv").value(), place.translation,
                                             frame_about(place.linear * Vector3d::UnitZ()), wheel, "wheel"));
    annotation.regions.push_back(make_region(PointGroup::parse("Cs").value(), place.translation,
                                             frame_about(place.linear * Vector3d::UnitY()), both, "wheel and lug"));
  }
  SymmetryAnnotation given = empty_annotation(mesh, 1e-3);
  given.regions = annotation.regions;
  for (int i = 0; i < 4; ++i) given.regions[static_cast<std::size_t>(i)].id = i;
  set_parents(given.regions);
  const ConsistentAnnotation result = consistent_annotation(mesh, given, RunContext{});
  EXPECT_EQ(result.annotation.regions.size(), 4U) << said(result);
  expect_exact(mesh, result.annotation);
}

}  // namespace
}  // namespace orbifit
