#include "evidence/cut_discs.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "placements.h"
#include "shapes.h"

namespace orbifit {
namespace {

// Faces of a prism of n sides whose middles are within some radius, about its axis.
struct Disc {
  const char* name;
  int sides;
  double radius;  // the prism's is 1
  double height;
  bool expected;  // that its discs are taken out

  friend void PrintTo(const Disc& disc, std::ostream* out) { *out << disc.name; }
};

class DiscsOfAPrism : public testing::TestWithParam<Disc> {};

TEST_P(DiscsOfAPrism, AreTakenOut) {
  const auto& [name, sides, radius, height, expected] = GetParam();
  const PreparedMesh prepared = prepare(test::subdivided(test::prism(sides, 1, height), 4));
  const Points middles = face_centroids(prepared.mesh);
  FoundRegion region;
  region.placement = test::normalised(prepared, {*PointGroup::parse("Dinfh"), GroupFrame::Identity(), {0, 0, 0}});
  for (int f = 0; f < middles.rows(); ++f) {
    const Eigen::Vector3d middle = prepared.input_of_normalised(Eigen::Vector3d(middles.row(f)));
    if (middle.head<2>().norm() < radius) region.faces.push_back(f);
  }
  region.area = area_of(prepared, region.faces);
  CutDiscs discs(prepared);
  for (const int face : discs.without(region)) {
    EXPECT_FALSE(expected && std::abs(prepared.normals(face, 2)) > 0.9) << "a face of an end";
  }
  EXPECT_EQ(discs.without(region) == region.faces, !expected);
  const std::vector<int> rest = discs.without(region);
  region.placement.group = *PointGroup::parse("C7v");
  EXPECT_EQ(discs.without(region), rest);
  region.placement.group = *PointGroup::parse("Ci");
  EXPECT_EQ(discs.without(region), region.faces) << "without an axis nothing is across it";
}

INSTANTIATE_TEST_SUITE_P(Prisms, DiscsOfAPrism,
                         testing::Values(Disc{"OfAHeptagon", 7, 0.85, 0.5, true}, Disc{"OfACoin", 60, 2, 0.1, false},
                                         Disc{"WithinACoin", 60, 0.7, 0.1, false}, Disc{"OfARod", 60, 2, 3, false}),
                         [](const auto& each) { return std::string(each.param.name); });

// A box and smaller ones apart from it.
struct Specks {
  const char* name;
  int count;
  double size;  // of each, the large one's is 1
  bool gone;

  friend void PrintTo(const Specks& specks, std::ostream* out) { *out << specks.name; }
};

class WithoutSpecks : public testing::TestWithParam<Specks> {};

TEST_P(WithoutSpecks, LeavesPartsThatCount) {
  const auto& [name, count, size, gone] = GetParam();
  std::vector<Mesh> parts{test::box(1, 1, 1)};
  for (int i = 0; i < count; ++i) parts.push_back(test::moved(test::box(size, size, size), test::shift(2 + i, 0, 0)));
  const PreparedMesh prepared = prepare(test::joined(parts));
  std::vector<int> all(static_cast<std::size_t>(prepared.mesh.faces.rows()));
  std::iota(all.begin(), all.end(), 0);
  const std::vector<int> kept = without_specks(prepared, face_sides(prepared), all);
  EXPECT_EQ(kept, gone ? prepared.components.faces[0] : all);
}

INSTANTIATE_TEST_SUITE_P(Boxes, WithoutSpecks,
                         testing::Values(Specks{"Few", 2, 0.09, true}, Specks{"Many", 5, 0.09, false},
                                         Specks{"Larger", 1, 0.15, false}, Specks{"None", 0, 1, true}),
                         [](const auto& each) { return std::string(each.param.name); });

// Two plates, one with a rod upon it, and a turned region that takes of them what is within 0.6 of the axis.
struct Plates {
  const char* name;
  const char* group;
  double rod;  // height
  bool stays;  // without its discs

  friend void PrintTo(const Plates& plates, std::ostream* out) { *out << plates.name; }
};

class DropCutDiscs : public testing::TestWithParam<Plates> {};

TEST_P(DropCutDiscs, KeepsWhatTurnsWithoutThem) {
  const auto& [name, group, rod, stays] = GetParam();
  std::vector<Mesh> parts{test::subdivided(test::box(2, 2, 0.2), 5)};
  if (rod > 0) {
    parts.push_back(test::moved(test::subdivided(test::prism(40, 0.3, rod), 2), test::shift(0, 0, 0.1 + 0.5 * rod)));
  }
  const PreparedMesh prepared = prepare(test::joined(parts));
  const Points middles = face_centroids(prepared.mesh);
  FoundRegion region;
  region.placement = test::normalised(prepared, {*PointGroup::parse(group), GroupFrame::Identity(), {0, 0, 0}});
  std::vector<int> of_rod;
  for (int f = 0; f < middles.rows(); ++f) {
    const Eigen::Vector3d middle = prepared.input_of_normalised(Eigen::Vector3d(middles.row(f)));
    if (middle.head<2>().norm() < 0.6) region.faces.push_back(f);
    if (prepared.components.component_of_face[static_cast<std::size_t>(f)] == 1) of_rod.push_back(f);
  }
  region.area = area_of(prepared, region.faces);
  std::vector<FoundRegion> regions{region};
  Explanation explanation;
  drop_cut_discs(prepared, test::kTolerance, RunContext{}, regions, &explanation);
  ASSERT_EQ(explanation.notes.size(), 1U);
  EXPECT_EQ(explanation.notes[0].kept, stays);
  ASSERT_EQ(regions.size(), stays ? 1U : 0U);
  if (stays) {
    EXPECT_EQ(regions[0].faces, of_rod);
    EXPECT_NEAR(regions[0].area, area_of(prepared, of_rod), 1e-12);
  }
}

// A plate with a bolt upon it, and the bolt's group on all within some radius.
struct Bolt {
  const char* name;
  double radius;  // of the disc around the bolt, whose corners are at 0.3
  double height;  // of the bolt
  double wide;    // more than the radius: the plate is round and the disc all of it
  bool stands_alone;

  friend void PrintTo(const Bolt& bolt, std::ostream* out) { *out << bolt.name; }
};

class BoltOnAPlate : public testing::TestWithParam<Bolt> {};

TEST_P(BoltOnAPlate, StandsAloneWhereTheDiscIsMostOfIt) {
  const auto& [name, radius, height, wide, stands_alone] = GetParam();
  const Mesh plate = wide > radius ? test::box(2 * wide, 2 * wide, 0.2) : test::prism(60, wide, 0.2);
  const Mesh bolt = test::moved(test::prism(6, 0.3, height), test::shift(0, 0, 0.1 + 0.5 * height));
  const PreparedMesh prepared = prepare(test::joined({test::subdivided(plate, 5), test::subdivided(bolt, 2)}));
  const Points middles = face_centroids(prepared.mesh);
  FoundRegion region;
  region.placement = test::normalised(prepared, {*PointGroup::parse("C6v"), GroupFrame::Identity(), {0, 0, 0}});
  std::vector<int> of_bolt;
  for (int f = 0; f < middles.rows(); ++f) {
    const Eigen::Vector3d middle = prepared.input_of_normalised(Eigen::Vector3d(middles.row(f)));
    if (middle.head<2>().norm() < radius + 0.01 && middle.z() > 0) region.faces.push_back(f);
    if (prepared.components.component_of_face[static_cast<std::size_t>(f)] == 1) of_bolt.push_back(f);
  }
  region.area = area_of(prepared, region.faces);
  std::vector<FoundRegion> regions{region};
  drop_cut_discs(prepared, test::kTolerance, RunContext{}, regions);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].faces, stands_alone ? of_bolt : region.faces);
}

INSTANTIATE_TEST_SUITE_P(Bolts, BoltOnAPlate,
                         testing::Values(Bolt{"OnMuchPlate", 0.8, 0.4, 1, true}, Bolt{"Tall", 0.5, 2, 1, false},
                                         Bolt{"OnAllOfThePlate", 0.8, 0.4, 0.8, false}),
                         [](const auto& each) { return std::string(each.param.name); });

INSTANTIATE_TEST_SUITE_P(Boxes, DropCutDiscs,
                         testing::Values(Plates{"NothingElse", "Dinfh", 0, false}, Plates{"Rod", "Cinfv", 2, true},
                                         Plates{"Knob", "Cinfv", 0.02, false},
                                         Plates{"NoMirrorAcross", "Dinfh", 2, false}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace orbifit
