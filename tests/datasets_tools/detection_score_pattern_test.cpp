#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/detection_score.h"

#include "scored.h"

namespace orbifit {
namespace {

using namespace scored;
using Eigen::Vector3d;
using Patterns = std::vector<Pattern>;
using Regions = std::vector<Region>;

Motion step_by(const Vector3d& way) {
  return {Eigen::Matrix3d::Identity(), way};
}

// Five copies of a chiral body in a row beside another body.
class PatternScores : public testing::Test {
 protected:
  static constexpr int kCopies = 5;

  void SetUp() override {
    const Mesh body = orbit_scene("C1", GroupFrame::Identity(), 3).mesh;
    const Vector3d way(1.7, 0.2, 0.1);
    row_.kind = Pattern::Kind::translation_1d;
    row_.name = "row";
    row_.generators = {step_by(way)};
    for (int j = 0; j < kCopies; ++j) {
      const Motion motion = step_by(j * way);
      row_.instances.push_back({motion, scene_.add(moved_mesh(body, motion))});
    }
    scene_.add(moved_mesh(body, Motion::rotation({0.6, 0, 0.8}, 1, {3, 4, 5})));
    scene_.truth.expected = scene_.nothing();
    scene_.truth.expected.patterns = {row_};
  }

  void expect(const DetectionScore& score, bool strict, bool loose) const {
    EXPECT_EQ(score.expected_patterns.at(0).strict, strict) << to_text(score);
    EXPECT_EQ(score.expected_patterns.at(0).loose, loose) << to_text(score);
  }

  // The body turned about its middle on top of the motion.
  Motion turned(const PatternInstance& instance, double degrees) const {
    Vector3d middle = Vector3d::Zero();
    for (const int face : instance.faces) {
      for (int k = 0; k < 3; ++k) middle += scene_.mesh.vertices.row(scene_.mesh.faces(face, k)).transpose();
    }
    middle /= 3.0 * static_cast<double>(instance.faces.size());
    return Motion::rotation({0, 0.6, 0.8}, degrees * kDegree, middle) * instance.motion;
  }

  // The same copies without a lattice, so that their motions are free.
  Pattern loose_row() const {
    Pattern pattern = row_;
    pattern.kind = Pattern::Kind::congruent;
    pattern.generators.clear();
    return pattern;
  }

  Scene scene_;
  Pattern row_;
};

TEST_F(PatternScores, TruthScoresFull) {
  const DetectionScore score = scene_.score(Patterns{row_});
  EXPECT_TRUE(score.breaches.empty());
  expect(score, true, true);
  EXPECT_EQ(score.patterns[0].validity, 1);
  EXPECT_EQ(score.patterns[0].trivial, Triviality::none);
  EXPECT_NEAR(score.patterns[0].area, 5.0 / 6, 1e-12);
  EXPECT_TRUE(score.patterns[0].matches.has_value());
  EXPECT_EQ(score.summary.f1, 1);
  EXPECT_FALSE(score.summary.axis_error.has_value());
  // The kind is no part of the claim.
  expect(scene_.score(Patterns{loose_row()}), true, true);
}

TEST_F(PatternScores, OrderAndFirstInstanceAreFree) {
  Pattern other = row_;
  std::swap(other.instances[0], other.instances[3]);
  std::swap(other.instances[1], other.instances[4]);
  const Motion back = inverse(other.instances[0].motion);
  for (PatternInstance& instance : other.instances) instance.motion = instance.motion * back;
  expect(scene_.score(Patterns{other}), true, true);
}

TEST_F(PatternScores, SixInstancesOfTenAreFoundLoosely) {
  Pattern fewer = row_;
  fewer.instances.resize(4);
  expect(scene_.score(Patterns{fewer}), false, true);
  fewer.instances.resize(3);
  expect(scene_.score(Patterns{fewer}), false, true);
  fewer.instances.resize(2);
  const DetectionScore two = scene_.score(Patterns{fewer});
  expect(two, false, false);
  EXPECT_EQ(two.summary.precision, 1) << "two copies are copies";
}

TEST_F(PatternScores, InstancesAreFoundByArea) {
  for (const auto& [share, strict, loose] : {std::tuple{0.72, true, true}, std::tuple{0.68, false, true},
                                             std::tuple{0.52, false, true}, std::tuple{0.48, false, false}}) {
    Pattern part = row_;
    for (PatternInstance& instance : part.instances) instance.faces = share_of(scene_.mesh, instance.faces, share);
    expect(scene_.score(Patterns{part}), strict, loose);
  }
}

TEST_F(PatternScores, MotionsMustAgreeOrMapAsWell) {
  Pattern pattern = loose_row();
  for (std::size_t j = 1; j < pattern.instances.size(); ++j) {
    pattern.instances[j].motion = turned(row_.instances[j], 0.9);
  }
  expect(scene_.score(Patterns{pattern}), true, true);
  // Two of five wrong: three are enough for loosely; three wrong are too many.
  pattern = loose_row();
  pattern.instances[3].motion = turned(row_.instances[3], 40);
  pattern.instances[4].motion = turned(row_.instances[4], 40);
  const DetectionScore two = scene_.score(Patterns{pattern});
  expect(two, false, true);
  EXPECT_LT(two.patterns[0].validity, 0.9);
  EXPECT_GT(two.patterns[0].validity, 0.5);
  pattern.instances[2].motion = turned(row_.instances[2], 40);
  const DetectionScore three = scene_.score(Patterns{pattern});
  expect(three, false, false);
  EXPECT_EQ(three.summary.precision, 0);
}

TEST_F(PatternScores, MotionsUpToASymmetryOfTheInstanceAreRight) {
  // Bodies with a half turn: copies may be related by it as well.
  Scene scene;
  const Scene body = orbit_scene("C2", GroupFrame::Identity());
  const Motion half = body.truth.expected.regions[0].elements[1];
  Pattern row = loose_row();
  row.instances.clear();
  for (int j = 0; j < 4; ++j) {
    const Motion motion = step_by(j * Vector3d(3, 0.3, 0.2));
    row.instances.push_back({motion, scene.add(moved_mesh(body.mesh, motion))});
  }
  scene.truth.expected = scene.nothing();
  scene.truth.expected.patterns = {row};
  Pattern turned = row;
  for (const std::size_t j : {1U, 3U}) turned.instances[j].motion = row.instances[j].motion * half;
  EXPECT_TRUE(scene.score(Patterns{turned}).expected_patterns[0].strict);
  EXPECT_EQ(scene.score(Patterns{turned}).patterns[0].validity, 1);
}

TEST_F(PatternScores, RepeatedPatternsCountOnce) {
  Pattern shuffled = loose_row();
  const DetectionScore score = scene_.score(Patterns{row_, shuffled});
  EXPECT_FALSE(score.patterns[0].duplicate_of.has_value());
  EXPECT_EQ(score.patterns[1].duplicate_of, 0);
  EXPECT_EQ(score.summary.precision, 0.5);
  Pattern fewer = row_;
  fewer.instances.resize(4);
  EXPECT_FALSE(scene_.score(Patterns{row_, fewer}).patterns[1].duplicate_of.has_value());
}

TEST_F(PatternScores, OptionalPatternsCountAndAreNotMissed) {
  scene_.truth.optional_patterns = {row_};
  scene_.truth.expected.patterns.clear();
  const DetectionScore score = scene_.score(Patterns{row_});
  EXPECT_EQ(score.summary.expected, 0);
  EXPECT_EQ(score.summary.precision, 1);
  ASSERT_TRUE(score.patterns[0].matches.has_value());
  EXPECT_TRUE(score.patterns[0].matches->optional);
}

TEST_F(PatternScores, ARegionMayRelateTheInstances) {
  Scene scene = orbit_scene("C4", GroupFrame::Identity());
  const Region whole = scene.truth.expected.regions.front();
  Pattern copies = loose_row();
  copies.instances.clear();
  const std::size_t count = whole.faces.size() / 4;
  for (std::size_t j = 0; j < 4; ++j) {
    const auto first = whole.faces.begin() + static_cast<std::ptrdiff_t>(j * count);
    copies.instances.push_back({whole.elements[j], {first, first + static_cast<std::ptrdiff_t>(count)}});
  }
  scene.truth.expected.regions.clear();
  scene.truth.expected.patterns = {copies};
  const DetectionScore by_region = scene.score(Regions{whole});
  EXPECT_TRUE(by_region.expected_patterns[0].strict);
  EXPECT_TRUE(by_region.expected_patterns[0].by_region);
  EXPECT_EQ(by_region.summary.strict_recall, 1);
  // Half of the group relates half of the copies.
  const Region half = make_region(group_named("C2"), whole.centre, GroupFrame::Identity(), whole.faces, "");
  EXPECT_FALSE(scene.score(Regions{half}).expected_patterns[0].loose);
  Region part = whole;
  part.faces = share_of(scene.mesh, whole.faces, 0.8);
  EXPECT_FALSE(scene.score(Regions{part}).expected_patterns[0].loose);
  // Copies on a lattice have to be found as such.
  scene.truth.expected.patterns[0].kind = Pattern::Kind::rotation;
  scene.truth.expected.patterns[0].generators = {whole.elements[1]};
  EXPECT_FALSE(scene.score(Regions{whole}).expected_patterns[0].loose);
}

// Four tiles of a strip.
struct Tiles {
  std::string name;
  double bumps;  // height of what is on each tile
  bool around;   // the strip is bent to a ring about z
  bool featureless;
};

void PrintTo(const Tiles& tiles, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's
  *out << tiles.name;
}

class TiledStrip : public testing::TestWithParam<Tiles> {};

TEST_P(TiledStrip, IsFeaturelessWithoutBumps) {
  constexpr int kColumns = 160;
  constexpr int kRows = 20;
  constexpr int kTile = 20;  // columns
  const Tiles& tiles = GetParam();
  Scene scene;
  scene.add(bent_grid(kColumns, kRows, [&](double u, double v) {
    const double along = 8 * u - std::floor(8 * u) - 0.5;
    const double height = tiles.bumps * std::exp(-60 * along * along) * (1 + v);
    if (!tiles.around) return Vector3d(4 * u, v, height);
    return Vector3d((1 + height) * std::cos(4 * u), (1 + height) * std::sin(4 * u), v);
  }));
  Pattern pattern;
  pattern.kind = tiles.around ? Pattern::Kind::rotation : Pattern::Kind::translation_1d;
  const Motion step = tiles.around ? Motion::rotation(Vector3d::UnitZ(), 0.5, Vector3d::Zero()) : step_by({0.5, 0, 0});
  pattern.generators = {step};
  Motion motion;
  for (int j = 0; j < 4; ++j, motion = step * motion) {
    PatternInstance& instance = pattern.instances.emplace_back();
    instance.motion = motion;
    for (int row = 0; row < kRows; ++row) {
      for (int column = (j + 2) * kTile; column < (j + 3) * kTile; ++column) {
        const int face = 2 * (row * kColumns + column);
        instance.faces.push_back(face);
        instance.faces.push_back(face + 1);
      }
    }
  }
  scene.expect({});
  const DetectionScore score = scene.score(Patterns{pattern});
  EXPECT_TRUE(score.breaches.empty()) << to_text(score);
  EXPECT_EQ(score.patterns[0].validity, 1);
  EXPECT_EQ(score.patterns[0].trivial, tiles.featureless ? Triviality::featureless : Triviality::none)
      << to_text(score);
}

INSTANTIATE_TEST_SUITE_P(Strips, TiledStrip,
                         testing::Values(Tiles{"flat", 0, false, true}, Tiles{"flat with bumps", 0.1, false, false},
                                         Tiles{"ring", 0, true, true}, Tiles{"ring with bumps", 0.1, true, false}));

}  // namespace
}  // namespace orbifit
