// The order and the length of lists.

#include "evidence/importance.h"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

std::vector<int> faces_from(int first, int count) {
  std::vector<int> result;
  for (int k = 0; k < count; ++k) result.push_back(first + k);
  return result;
}

// A plate on four square legs.
struct Table {
  Mesh mesh = test::joined({test::moved(test::box(4, 4, 0.4), test::shift(0, 0, 1)), leg(1), leg(2), leg(3), leg(4)});
  SymmetryAnnotation annotation = empty_annotation(mesh, test::kTolerance);

  static Vector3d foot(int quadrant) {
    return {quadrant == 1 || quadrant == 4 ? 1.5 : -1.5, quadrant <= 2 ? 1.5 : -1.5, 0};
  }
  static Mesh leg(int quadrant) {
    return test::moved(test::box(0.5, 0.5, 1.6), Motion{Eigen::Matrix3d::Identity(), foot(quadrant)});
  }

  void add(const char* group, const Vector3d& centre, std::vector<int> faces) {
    Region region = make_region(*PointGroup::parse(group), centre, GroupFrame::Identity(), std::move(faces), group);
    region.id = static_cast<int>(annotation.regions.size());
    annotation.regions.push_back(std::move(region));
  }
  void add_whole() { add("C4v", Vector3d::Zero(), test::all_faces(mesh)); }
  void add_legs() {
    for (int quadrant = 1; quadrant <= 4; ++quadrant) add("D4h", foot(quadrant), faces_from(12 * quadrant, 12));
  }
  auto list(bool all = false) { return list_by_importance(prepare(mesh), annotation, all, nullptr, {}); }
};

TEST(Importance, IsTheShareOfTheQuotientThatAGroupSaves) {
  Table table;
  table.add_legs();
  table.add_whole();
  const auto families = table.list();
  ASSERT_EQ(families.size(), 2U);
  EXPECT_EQ(families[0].size(), 1U);
  EXPECT_EQ(families[1].size(), 4U);
  EXPECT_EQ(table.annotation.regions[0].name, "C4v");
  EXPECT_NEAR(*table.annotation.regions[0].importance, 7.0 / 8, 0.03);
  // A leg, on a plane of the whole, is known up to its other half; its group leaves a sixteenth.
  const double leg = 2 * 0.25 + 4 * 0.5 * 1.6;
  const double plate = 2 * 16 + 4 * 4 * 0.4;
  const double left = (plate + 4 * leg) / 8;
  for (std::size_t k = 1; k < 5; ++k) {
    EXPECT_NEAR(*table.annotation.regions[k].importance, (leg / 2 - leg / 16) / left, 0.05) << k;
    EXPECT_EQ(table.annotation.regions[k].id, static_cast<int>(k));
    EXPECT_EQ(table.annotation.regions[k].parent, 0);
  }
}

// Borders are drawn face by face, here four sides too early: the motions of the whole take the legs to one another all
// the same, and without one of them the rest would lack an image.
TEST(Importance, WhatMotionsTakeToOneAnotherIsListedTogether) {
  Table table;
  table.add_whole();
  table.add_legs();
  table.annotation.regions[2].faces.resize(4);
  const auto families = table.list();
  ASSERT_EQ(families.size(), 2U);
  EXPECT_EQ(families[1].size(), 4U);
}

TEST(Importance, ListsNothingTwiceUnlessAskedFor) {
  for (const bool all : {false, true}) {
    Table table;
    table.add_whole();
    table.add("C2v", Vector3d::Zero(), test::all_faces(table.mesh));
    table.list(all);
    ASSERT_EQ(table.annotation.regions.size(), all ? 2U : 1U);
    EXPECT_EQ(table.annotation.regions[0].name, "C4v");
    if (all) {
      EXPECT_LT(*table.annotation.regions[1].importance, 1e-6);
    }
  }
}

TEST(Importance, ARoundPartLeavesNothingForItsFiniteGroups) {
  const Mesh mesh = test::prism(48, 1, 1);
  SymmetryAnnotation annotation = empty_annotation(mesh, test::kTolerance);
  int id = 0;
  for (const char* group : {"D5h", "Dinfh", "C2v"}) {
    annotation.regions.push_back(
        make_region(*PointGroup::parse(group), Vector3d::Zero(), GroupFrame::Identity(), test::all_faces(mesh), group));
    annotation.regions.back().id = id++;
  }
  list_by_importance(prepare(mesh), annotation, false, nullptr, {});
  ASSERT_EQ(annotation.regions.size(), 1U);
  EXPECT_EQ(annotation.regions[0].name, "Dinfh");
}

TEST(Importance, TheFlipOfAPartHalvesWhatItsRotationsLeave) {
  // A cylinder on a wider one: both turn about the axis, the lower one alone has a flip.
  const Mesh lower = test::prism(48, 1, 1);
  const Mesh mesh = test::joined({lower, test::moved(test::prism(48, 0.5, 1), test::shift(0, 0, 1))});
  SymmetryAnnotation annotation = empty_annotation(mesh, test::kTolerance);
  const auto add = [&](const char* group, const Vector3d& centre, std::vector<int> faces) {
    annotation.regions.push_back(
        make_region(*PointGroup::parse(group), centre, GroupFrame::Identity(), std::move(faces), group));
    annotation.regions.back().id = static_cast<int>(annotation.regions.size()) - 1;
  };
  add("Dinfh", Vector3d::Zero(), test::all_faces(lower));
  add("Cinfv", Vector3d::Zero(), test::all_faces(mesh));
  list_by_importance(prepare(mesh), annotation, false, nullptr, {});
  ASSERT_EQ(annotation.regions.size(), 2U);
  EXPECT_EQ(annotation.regions[0].name, "Cinfv");
  EXPECT_GT(*annotation.regions[0].importance, 0.9);
  // Half of the lower cylinder's share of the area.
  const double round = 2 * std::numbers::pi;
  const double share = 2 * round / (2 * round + round / 4 + round / 2);
  EXPECT_NEAR(*annotation.regions[1].importance, share / 2, 0.05);
}

TEST(Importance, WhatTellsHowPartsStandToOneAnotherIsListed) {
  // Two boxes, unlike and each with a group of its own, and the mirror that both share.
  const Mesh box = test::box(2, 1, 1);
  const Mesh mesh = test::joined({box, test::moved(test::box(1, 1, 3), test::shift(0, 0, 2))});
  for (const char* common : {"Cs", "C2v"}) {
    SymmetryAnnotation annotation = empty_annotation(mesh, test::kTolerance);
    const auto add = [&](const char* group, const Vector3d& centre, std::vector<int> faces) {
      annotation.regions.push_back(
          make_region(*PointGroup::parse(group), centre, GroupFrame::Identity(), std::move(faces), group));
      annotation.regions.back().id = static_cast<int>(annotation.regions.size()) - 1;
    };
    add("D2h", Vector3d::Zero(), test::all_faces(box));
    add("D2h", {0, 0, 2}, faces_from(12, 12));
    add(common, Vector3d::Zero(), test::all_faces(mesh));
    list_by_importance(prepare(mesh), annotation, false, nullptr, {});
    ASSERT_EQ(annotation.regions.size(), 3U) << common;
    // A part of the first box that others hold says nothing more.
    add("Cs", Vector3d::Zero(), faces_from(0, 12));
    list_by_importance(prepare(mesh), annotation, false, nullptr, {});
    EXPECT_EQ(annotation.regions.size(), 3U) << common;
  }
}

// A mirror of the whole is listed beside a larger group of all but a small part.
TEST(Importance, NothingButTheWholeHoldsTheWhole) {
  Table table;
  const std::vector<int> all_but_the_knob = test::all_faces(table.mesh);
  table.mesh = test::joined({table.mesh, test::moved(test::box(0.4, 0.4, 0.2), test::shift(0, 1, 1.3))});
  table.annotation = empty_annotation(table.mesh, test::kTolerance);
  table.add("C2v", Vector3d::Zero(), all_but_the_knob);
  Region whole = make_region(*PointGroup::parse("Cs"), Vector3d::Zero(), frame_about(Vector3d::UnitX()),
                             test::all_faces(table.mesh), "Cs");
  whole.id = 1;
  table.annotation.regions.push_back(whole);
  table.list();
  EXPECT_TRUE(std::ranges::any_of(table.annotation.regions, [](const Region& region) { return region.name == "Cs"; }));
}

}  // namespace
}  // namespace orbifit
