#include "resolution/transfer.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/detection/detect.h"
#include "orbifit/model/annotation_io.h"

#include "shapes.h"

namespace orbifit {
namespace {

constexpr int kAlways = 1;
constexpr int kNever = 0;

SymmetryAnnotation detected(const Mesh& mesh, int simplify_above_faces, int threads = 1,
                            Explanation* explanation = nullptr) {
  DetectOptions options;
  options.tolerance = 0.02;  // of the diagonal, so that meshes of few faces are fine
  options.simplify_above_faces = simplify_above_faces;
  options.explanation = explanation;
  RunContext context;
  context.threads = threads;
  return detect(mesh, options, context);
}

double overlap(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> common;
  std::ranges::set_intersection(a, b, std::back_inserter(common));
  return static_cast<double>(common.size()) / static_cast<double>(a.size() + b.size() - common.size());
}

struct FineModel {
  std::string name;
  Mesh mesh;
};

void PrintTo(const FineModel& model, std::ostream* out) {
  *out << model.name;
}

Mesh four_legs() {
  std::vector<Mesh> parts{test::box(2, 2, 0.1)};
  const Mesh leg = test::moved(test::box(0.3, 0.2, 1.2), test::shift(0.75, 0.8, -0.6));
  for (int i = 0; i < 4; ++i) {
    parts.push_back(test::moved(leg, Motion::rotation({0, 0, 1}, i * std::numbers::pi / 2, {0, 0, 0})));
  }
  return test::subdivided(test::joined(parts), 4);
}

std::vector<FineModel> models() {
  return {{"Legs", four_legs()},
          {"Prism", test::subdivided(test::prism(5, 1, 1), 5)},
          {"Box", test::subdivided(test::box(1, 1, 2), 5)}};
}

std::string summary_of(const SymmetryAnnotation& annotation) {
  std::string text;
  for (const Region& region : annotation.regions) {
    text += region.group.symbol() + " on " + std::to_string(region.faces.size()) + ", ";
  }
  return text;
}

class FineModels : public testing::TestWithParam<FineModel> {};

TEST_P(FineModels, HaveTheRegionsTheyHaveWithoutAStandIn) {
  const Mesh& mesh = GetParam().mesh;
  Explanation explanation;
  const SymmetryAnnotation direct = detected(mesh, kNever);
  const SymmetryAnnotation carried = detected(mesh, kAlways, 1, &explanation);
  EXPECT_EQ(explanation.notes.front().stage, "coarse mesh");
  ASSERT_EQ(carried.regions.size(), direct.regions.size()) << summary_of(carried) << "not " << summary_of(direct);
  for (const Region& region : direct.regions) {
    const auto same = std::ranges::find_if(carried.regions, [&](const Region& other) {
      return other.group == region.group && overlap(other.faces, region.faces) > 0.95;
    });
    ASSERT_TRUE(same != carried.regions.end())
        << region.group.symbol() << " on " << region.faces.size() << " faces; there are " << summary_of(carried);
    EXPECT_LE(same->residual.max, 1.1 * region.residual.max + 1e-9) << region.name;
    EXPECT_EQ(same->parent.has_value(), region.parent.has_value());
  }
  ASSERT_EQ(carried.patterns.size(), direct.patterns.size());
  for (std::size_t i = 0; i < direct.patterns.size(); ++i) {
    EXPECT_EQ(carried.patterns[i].kind, direct.patterns[i].kind);
    EXPECT_EQ(carried.patterns[i].instances.size(), direct.patterns[i].instances.size());
    EXPECT_LE(carried.patterns[i].residual.max, 1.1 * direct.patterns[i].residual.max + 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, FineModels, testing::ValuesIn(models()),
                         [](const auto& each) { return each.param.name; });

TEST(CarryBack, DoesNotDependOnThreads) {
  const Mesh mesh = four_legs();
  EXPECT_EQ(to_json(detected(mesh, kAlways, 1)), to_json(detected(mesh, kAlways, 2)));
}

TEST(CarryBack, LeavesCoarseMeshesAlone) {
  Explanation explanation;
  const Mesh mesh = test::box(1, 2, 3);
  EXPECT_EQ(to_json(detected(mesh, kAlways, 1, &explanation)), to_json(detected(mesh, kNever)));
  EXPECT_NE(explanation.notes.front().stage, "coarse mesh");
}

// A row of bodies without a symmetry of their own.
TEST(CarryBack, ARowStaysOnItsLattice) {
  std::vector<Mesh> parts;
  for (int i = 0; i < 4; ++i) parts.push_back(test::moved(test::scalene(), test::shift(1.5 * i, 0.2 * i, 0)));
  const SymmetryAnnotation found = detected(test::subdivided(test::joined(parts), 5), kAlways);
  ASSERT_EQ(found.patterns.size(), 1U);
  const Pattern& row = found.patterns.front();
  EXPECT_EQ(row.kind, Pattern::Kind::translation_1d);
  ASSERT_EQ(row.instances.size(), 4U);
  EXPECT_LT(row.residual.max, 1e-9);
  const double way = row.generators.front().translation.norm();
  EXPECT_NEAR(way, Eigen::Vector3d(1.5, 0.2, 0).norm(), 1e-9);
  EXPECT_NEAR((row.generators.front().linear - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
}

// C4 and C2 of a table's four legs, as found on a coarse mesh, carried back with or without time left.
std::vector<std::string> carried_groups(bool time_left, Explanation& explanation) {
  constexpr double kTolerance = 0.02;
  const PreparedMesh fine = prepare(four_legs());
  const std::optional<CoarseMesh> coarse = coarse_mesh(fine, {kTolerance, 0}, {});
  if (!coarse) return {"no coarse mesh"};
  const PreparedMesh proxy_face = prepare(coarse->mesh);
  const Eigen::Vector3d centre =
      inverse(proxy_face.input_of_normalised)(inverse(fine.input_of_normalised)(Eigen::Vector3d(0, 0, 0)));
  Findings found;
  for (const char* group : {"C4", "C2"}) {
    const GroupPlacement placement{*PointGroup::parse(group), GroupFrame::Identity(), centre};
    found.regions.push_back({placement, test::all_faces(coarse->mesh), proxy_face.area, group});
  }
  const auto late = [&](double) { return !time_left; };
  std::vector<std::string> groups;
  for (const FoundRegion& region :
       transferred(fine, *coarse, proxy_face, std::move(found), {kTolerance, 2000, &explanation, late}, {}).regions) {
    groups.push_back(region.placement.group.symbol());
  }
  return groups;
}

TEST(CarryBack, LeavesOutWhatThereIsNoTimeForButTheLargest) {
  Explanation explanation;
  EXPECT_EQ(carried_groups(true, explanation), (std::vector<std::string>{"C4", "C2"}));
  EXPECT_TRUE(explanation.notes.empty());
  EXPECT_EQ(carried_groups(false, explanation), std::vector<std::string>{"C4"});
  ASSERT_EQ(explanation.notes.size(), 1U);
  EXPECT_EQ(explanation.notes.front().reason, "no time left");
}

}  // namespace
}  // namespace orbifit
