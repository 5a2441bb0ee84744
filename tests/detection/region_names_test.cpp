// What regions and patterns are called.

#include "region_names.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

/// A box on four legs, a ring in the middle of it.
class RegionNames : public ::testing::Test {
 protected:
  static Mesh leg(double x, double y) { return test::moved(test::box(0.5, 0.5, 2), test::shift(x, y, 0)); }

  void add(const char* group, const Vector3d& centre, int first, int count) {
    std::vector<int> faces;
    for (int k = 0; k < count; ++k) faces.push_back(first + k);
    annotation_.regions.push_back(
        make_region(*PointGroup::parse(group), centre, GroupFrame::Identity(), std::move(faces), "as found"));
    annotation_.regions.back().id = static_cast<int>(annotation_.regions.size()) - 1;
  }

  std::vector<std::string> names(const std::vector<std::vector<std::size_t>>& families, const Vector3d& up) {
    const PartNames parts(parts_, static_cast<std::size_t>(mesh_.faces.rows()));
    name_by_shape_and_place(prepare(mesh_), families, side_axes(up), parts, annotation_, &explanation_);
    std::vector<std::string> result;
    for (const Region& region : annotation_.regions) result.push_back(region.name);
    return result;
  }

  Mesh mesh_ = test::joined({test::moved(test::box(4, 4, 0.4), test::shift(0, 0, 1.2)), leg(-1.5, -1.5), leg(1.5, -1.5),
                             leg(1.5, 1.5), leg(-1.5, 1.5)});
  SymmetryAnnotation annotation_ = empty_annotation(mesh_, test::kTolerance);
  NamedParts parts_;
  Explanation explanation_;
};

TEST_F(RegionNames, SayWhatAndWhere) {
  add("C4v", Vector3d::Zero(), 0, 60);
  for (int k = 0; k < 4; ++k) add("D4h", Vector3d::Zero(), 12 * (k + 1), 12);
  add("D4h", {0, 0, 1.2}, 0, 12);
  const std::vector<std::vector<std::size_t>> families{{0}, {1, 2, 3, 4}, {5}};
  EXPECT_EQ(names(families, Vector3d::UnitZ()),
            (std::vector<std::string>{"whole", "bar 1 of 4, front left", "bar 2 of 4, front right",
                                      "bar 3 of 4, back right", "bar 4 of 4, back left", "upper plate"}));
  // Seen with z downwards, what was above is below.
  EXPECT_EQ(names(families, -Vector3d::UnitZ()).back(), "lower plate");
}

TEST_F(RegionNames, TellEqualOnesApart) {
  add("Cs", Vector3d::Zero(), 12, 48);
  add("C2v", Vector3d::Zero(), 12, 48);
  EXPECT_EQ(names({{0}, {1}}, Vector3d::UnitZ()),
            (std::vector<std::string>{"group of 4 parts", "group of 4 parts (2)"}));
}

TEST_F(RegionNames, SayWhatPatternsRepeat) {
  Pattern pattern;
  pattern.kind = Pattern::Kind::translation_1d;
  for (int k = 0; k < 2; ++k) {
    pattern.instances.push_back({test::shift(3 * k, 0, 0), {}});
    for (int f = 0; f < 12; ++f) pattern.instances.back().faces.push_back(12 * (k + 1) + f);
  }
  annotation_.patterns.push_back(pattern);
  names({}, Vector3d::UnitZ());
  EXPECT_EQ(annotation_.patterns[0].name, "row of 2 bars");
}

// The box is the "top"; the legs are numbered, or have names of their own.
TEST_F(RegionNames, AreThoseOfTheFileWhereThereAreAny) {
  for (int f = 0; f < 60; ++f) parts_.part_of_face.push_back(f / 12);
  for (int k = 0; k < 4; ++k) add("D4h", Vector3d::Zero(), 12 * (k + 1), 12);
  add("C4v", Vector3d::Zero(), 12, 48);
  add("C2v", Vector3d::Zero(), 0, 4);
  const std::vector<std::vector<std::size_t>> families{{0, 1, 2, 3}, {4}, {5}};
  parts_.names = {"top", "leg_1", "leg_2", "leg 3", "leg"};
  EXPECT_EQ(names(families, Vector3d::UnitZ()),
            (std::vector<std::string>{"leg 1 of 4, front left", "leg 2 of 4, front right", "leg 3 of 4, back right",
                                      "leg 4 of 4, back left", "group of 4 x leg", "upper plate of top"}));
  parts_.names = {"top", "ann", "bob", "cid", "dot"};
  EXPECT_EQ(names(families, Vector3d::UnitZ()),
            (std::vector<std::string>{"ann, front left", "bob, front right", "cid, back right", "dot, back left",
                                      "group of 4 parts", "upper plate of top"}));
}

// One name for all tells nothing apart, a number is no name, and what has no name is called by its shape.
TEST_F(RegionNames, AreByShapeWhereTheFileSaysNothing) {
  add("D4h", Vector3d::Zero(), 12, 12);
  const auto named = [&](const std::vector<std::string>& given, int first) {
    parts_ = {};
    for (int f = 0; f < 60; ++f) parts_.part_of_face.push_back(f < first ? -1 : given.size() == 1 ? 0 : f / 12);
    parts_.names = given;
    return names({{0}}, Vector3d::UnitZ()).front();
  };
  EXPECT_EQ(named({"mesh"}, 0), "front left bar");
  EXPECT_EQ(named({"part_1", "part_2", "part_3", "part_4", "part_5"}, 0), "front left bar");
  EXPECT_EQ(named({"1", "2", "3", "4", "5"}, 0), "front left bar");
  EXPECT_EQ(named({"a", "b", "c", "d", "e"}, 14), "front left bar");
  EXPECT_EQ(named({"a", "b", "c", "d", "e"}, 0), "front left b");
  EXPECT_EQ(named({"a", "b2", "b3", "d", "e"}, 0), "front left b");
  EXPECT_EQ(named({"a", "2 x 2", "c", "d", "e"}, 0), "front left 2 x 2");
}

TEST_F(RegionNames, AreExplained) {
  add("C4v", Vector3d::Zero(), 0, 60);
  names({{0}}, Vector3d::UnitZ());
  EXPECT_TRUE(std::ranges::any_of(explanation_.notes, [](const Explanation::Note& note) {
    return note.kept && note.subject == "C4v on whole" && note.reason == "found as as found";
  }));
}

TEST(RoundNames, AreByTheirProportions) {
  const auto name = [](const Mesh& mesh) {
    SymmetryAnnotation annotation = empty_annotation(mesh, test::kTolerance);
    const Mesh aside = test::joined({mesh, test::moved(test::box(9, 9, 9), test::shift(20, 0, 0))});
    annotation.regions.push_back(
        make_region(*PointGroup::parse("Dinfh"), Vector3d::Zero(), GroupFrame::Identity(), test::all_faces(mesh), ""));
    name_by_shape_and_place(prepare(aside), {{0}}, side_axes(Vector3d::UnitZ()), PartNames({}, 0), annotation, nullptr);
    return annotation.regions[0].name;
  };
  EXPECT_EQ(name(test::prism(48, 1, 0.2)), "left disc");
  EXPECT_EQ(name(test::prism(48, 1, 8)), "left rod");
  EXPECT_EQ(name(test::prism(48, 1, 2)), "left round part");
}

}  // namespace
}  // namespace orbifit
