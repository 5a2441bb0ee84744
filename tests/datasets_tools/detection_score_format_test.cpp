#include <algorithm>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/detection_score.h"

#include "scored.h"

// What a reader lets pass, or what never was in a file.

namespace orbifit {
namespace {

using namespace scored;
using Eigen::Vector3d;

struct Breach {
  std::string name;
  std::function<void(SymmetryAnnotation&)> commit;
  std::string message;
  bool spoils_first_region, spoils_first_pattern;
};

void PrintTo(const Breach& breach, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's
  *out << breach.name;
}

class FormatBreach : public testing::TestWithParam<Breach> {
 protected:
  // A body with a fourfold axis that stands in a row of three, a copy of itself turned away, and a turned part.
  FormatBreach() {
    const Scene body = orbit_scene("C4v", GroupFrame::Identity(), 1);
    Region square = body.truth.expected.regions.front();
    Pattern row;
    row.kind = Pattern::Kind::translation_1d;
    const Vector3d way(4, 0, 1);
    row.generators = {{Eigen::Matrix3d::Identity(), way}};
    std::vector<int> first_two;
    for (int j = 0; j < 3; ++j) {
      const Motion motion{Eigen::Matrix3d::Identity(), j * way};
      row.instances.push_back({motion, scene_.add(moved_mesh(body.mesh, motion))});
      if (j < 2)
        first_two.insert(first_two.end(), row.instances.back().faces.begin(), row.instances.back().faces.end());
    }
    Region pair = make_region(group_named("Cs"), square.centre, frame_about(Vector3d::UnitY()), first_two, "");
    Region ring = make_region(group_named("Dinfh"), Vector3d(0, 0, 5), GroupFrame::Identity(),
                              scene_.add(moved_mesh(turned_part([](double v) { return 1 + 0.2 * std::sin(3 * v); },
                                                                [](double v) { return v - 0.5; }),
                                                    {Eigen::Matrix3d::Identity(), Vector3d(0, 0, 5)})),
                              "");
    Pattern arc = row;
    arc.kind = Pattern::Kind::rotation;
    arc.generators = {Motion::rotation(Vector3d::UnitZ(), 0.3, {0, 9, 0})};
    Motion power;
    for (PatternInstance& instance : arc.instances) {
      instance.motion = power;
      power = arc.generators[0] * power;
    }
    good_ = scene_.nothing();
    good_.regions = {square, pair, ring};
    good_.patterns = {row, arc};
    for (int i = 0; i < 3; ++i) good_.regions[static_cast<std::size_t>(i)].id = i;
    for (int i = 0; i < 2; ++i) good_.patterns[static_cast<std::size_t>(i)].id = i;
    set_parents(good_.regions);
    scene_.truth.expected = scene_.nothing();
  }

  Scene scene_;
  SymmetryAnnotation good_;
};

TEST_P(FormatBreach, IsToldAndDoesNotCount) {
  ASSERT_TRUE(scene_.score(good_).breaches.empty()) << to_text(scene_.score(good_));
  SymmetryAnnotation bad = good_;
  GetParam().commit(bad);
  const DetectionScore score = scene_.score(bad);
  EXPECT_TRUE(std::ranges::any_of(score.breaches, [&](const std::string& text) {
    return text.find(GetParam().message) != text.npos;
  })) << to_text(score);
  EXPECT_EQ(score.regions[0].well_formed, !GetParam().spoils_first_region) << to_text(score);
  EXPECT_EQ(score.patterns[0].well_formed, !GetParam().spoils_first_pattern) << to_text(score);
  if (GetParam().spoils_first_region) {
    EXPECT_FALSE(score.regions[0].counts);
  }
  if (GetParam().spoils_first_pattern) {
    EXPECT_FALSE(score.patterns[0].counts);
  }
}

Region& first(SymmetryAnnotation& annotation) {
  return annotation.regions[0];
}
Pattern& row_of(SymmetryAnnotation& annotation) {
  return annotation.patterns[0];
}
Motion tilt(double radians) {
  return Motion::rotation(Vector3d::UnitX(), radians, {0.4, -0.3, 0.2});
}

INSTANTIATE_TEST_SUITE_P(
    Regions, FormatBreach,
    testing::Values(
        Breach{"group", [](auto& a) { first(a).group = group_named("D4"); }, "elements form C4v", true, false},
        Breach{"order", [](auto& a) { first(a).group = group_named("C4"); }, "C4 has 4 elements, the list has 8", true,
               false},
        Breach{"trivial group", [](auto& a) { first(a).group = {}; }, "unknown group symbol C1", true, false},
        Breach{"identity", [](auto& a) { std::swap(first(a).elements[0], first(a).elements[1]); },
               "first element is not the identity", true, false},
        Breach{"repeated", [](auto& a) { first(a).elements[3] = first(a).elements[2]; }, "listed twice", true, false},
        Breach{"closed", [](auto& a) { first(a).elements[3] = tilt(1); }, "not closed", true, false},
        Breach{"orthogonal", [](auto& a) { first(a).elements[3].linear *= 1.001; }, "not orthogonal", true, false},
        Breach{"empty", [](auto& a) { first(a).elements.clear(); }, "elements is empty", true, false},
        Breach{"generators", [](auto& a) { first(a).generators.clear(); }, "generators is empty", true, false},
        Breach{"few generators", [](auto& a) { first(a).generators.resize(1); }, "generate 4 elements, not 8", true,
               false},
        Breach{"other generator", [](auto& a) { first(a).generators[0] = tilt(0.1); }, "not among the elements", true,
               false},
        Breach{"axis", [](auto& a) { first(a).axis = tilt(0.06 * kDegree).linear * first(a).axis; },
               "degrees off the main axis", true, false},
        Breach{"length", [](auto& a) { first(a).axis *= 1.001; }, "not a unit vector", true, false},
        Breach{"centre", [](auto& a) { first(a).centre.x() += 0.01; }, "centre is moved", true, false},
        Breach{"faces", [](auto& a) { first(a).faces.clear(); }, "faces must be", true, false},
        Breach{"residual",
               [](auto& a) {
                 first(a).residual = {0.2, 0.1};
               },
               "residual", true, false},
        Breach{"continuous elements", [](auto& a) { a.regions[2].elements = {Motion{}}; }, "elements must be []", false,
               false},
        Breach{"continuous generator",
               [](auto& a) {
                 a.regions[2].generators = {Motion::about(tilt(0.1).linear, {0, 0, 5})};
               },
               "no element of Dinfh", false, false},
        Breach{"orphan", [](auto& a) { first(a).parent.reset(); }, "parent is null", false, false},
        Breach{"no such parent", [](auto& a) { first(a).parent = 9; }, "parent 9 does not exist", false, false},
        Breach{"false parent", [](auto& a) { first(a).parent = 2; }, "parent 2 does not strictly contain", false,
               false},
        Breach{"id", [](auto& a) { a.regions[2].id = 1; }, "an id occurs twice", false, false},
        Breach{"tolerance", [](auto& a) { a.tolerance = 0; }, "tolerance", false, false},
        Breach{"diagonal", [](auto& a) { a.mesh_diagonal *= 1.01; }, "diagonal", false, false}));

INSTANTIATE_TEST_SUITE_P(
    Patterns, FormatBreach,
    testing::Values(
        Breach{"alone", [](auto& a) { row_of(a).instances.resize(1); }, "at least two instances", false, true},
        Breach{"shared", [](auto& a) { row_of(a).instances[2].faces = row_of(a).instances[1].faces; }, "shares faces",
               false, true},
        Breach{"first", [](auto& a) { row_of(a).instances[0].motion = row_of(a).instances[1].motion; },
               "instance 0 is not the identity", false, true},
        Breach{"number", [](auto& a) { row_of(a).generators.clear(); }, "needs 1 generators, not 0", false, true},
        Breach{"translation", [](auto& a) { row_of(a).generators[0] = tilt(0.1); }, "is not a translation", false,
               true},
        Breach{"half a step", [](auto& a) { row_of(a).instances[2].motion.translation.x() += 2; }, "whole-number",
               false, true},
        Breach{"dependent",
               [](auto& a) {
                 row_of(a).kind = Pattern::Kind::translation_2d;
                 row_of(a).generators.push_back(row_of(a).generators[0]);
               },
               "linearly dependent", false, true},
        Breach{"residual",
               [](auto& a) {
                 row_of(a).residual = {1, 0};
               },
               "residual", false, true},
        Breach{"mirror",
               [](auto& a) {
                 a.patterns[1].generators[0] = Motion::reflection(Vector3d::UnitX(), {1, 0, 0});
               },
               "proper rotation", false, false},
        Breach{"power", [](auto& a) { a.patterns[1].instances[2].motion = a.patterns[1].generators[0] * tilt(0.2); },
               "no power of the generator", false, false},
        Breach{"pitch", [](auto& a) { a.patterns[1].generators[0].translation.z() += 1; }, "moves along its axis",
               false, false},
        Breach{"no pitch", [](auto& a) { a.patterns[1].kind = Pattern::Kind::screw; }, "does not move along its axis",
               false, false},
        Breach{"not orthogonal", [](auto& a) { row_of(a).instances[1].motion.linear *= 1.01; }, "not orthogonal", false,
               true}));

}  // namespace
}  // namespace orbifit
