#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/detection_score.h"

#include "scored.h"

// Continuous groups, and claims about featureless surfaces.

namespace orbifit {
namespace {

using namespace scored;
using Eigen::Vector3d;
using Regions = std::vector<Region>;

constexpr double kPi = std::numbers::pi;

// Turned about z, of no other symmetry.
Mesh vase() {
  return turned_part([](double v) { return 0.3 + 0.1 * std::sin(5 * v) + 0.1 * v * v; }, [](double v) { return v; });
}

// Turned about z, and the same upside down.
Mesh spool() {
  return turned_part([](double v) { return 0.3 + 0.15 * std::cos(2 * kPi * v); }, [](double v) { return v - 0.5; });
}

Mesh ball() {
  return turned_part([](double v) { return std::sin(kPi * v); }, [](double v) { return -std::cos(kPi * v); });
}

struct SurfaceClaim {
  std::string shape, truth, claim;
  bool strict, loose, counts;
};

void PrintTo(const SurfaceClaim& claim, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's
  *out << claim.claim << " on " << claim.shape;
}

class ContinuousGroup : public testing::TestWithParam<SurfaceClaim> {};

TEST_P(ContinuousGroup, HoldsItsSubgroups) {
  const SurfaceClaim& claim = GetParam();
  Scene scene;
  const std::vector<int> faces = scene.add(claim.shape == "vase" ? vase() : claim.shape == "spool" ? spool() : ball());
  const auto whole = [&](const std::string& symbol) {
    return make_region(group_named(symbol), Vector3d::Zero(), GroupFrame::Identity(), faces, "");
  };
  scene.expect({whole(claim.truth)});
  const DetectionScore score = scene.score(Regions{whole(claim.claim)});
  EXPECT_TRUE(score.breaches.empty());
  EXPECT_EQ(score.expected_regions[0].strict, claim.strict) << to_text(score);
  EXPECT_EQ(score.expected_regions[0].loose, claim.loose) << to_text(score);
  EXPECT_EQ(score.regions[0].counts, claim.counts) << to_text(score);
}

INSTANTIATE_TEST_SUITE_P(
    Claims, ContinuousGroup,
    testing::Values(SurfaceClaim{"vase", "Cinfv", "Cinfv", true, true, true},
                    SurfaceClaim{"vase", "Cinfv", "Cinf", false, true, true},
                    // The whole mesh, but not what it has.
                    SurfaceClaim{"vase", "Cinfv", "Dinfh", false, true, false},
                    SurfaceClaim{"vase", "Cinfv", "K", false, false, false},
                    SurfaceClaim{"vase", "Cinfv", "Kh", false, true, false},
                    SurfaceClaim{"vase", "Cinfv", "Dinf", false, false, false},
                    // True, but a finite group is less than a continuous one; it slides along the vase's own turns.
                    SurfaceClaim{"vase", "Cinfv", "C8v", false, false, false},
                    SurfaceClaim{"spool", "Dinfh", "Dinfh", true, true, true},
                    SurfaceClaim{"spool", "Dinfh", "Cinfv", false, true, true},
                    SurfaceClaim{"spool", "Dinfh", "Cinfh", false, true, true},
                    SurfaceClaim{"spool", "Dinfh", "Dinf", false, true, true},
                    SurfaceClaim{"spool", "Dinfh", "Cinf", false, false, true},
                    SurfaceClaim{"ball", "Kh", "Kh", true, true, true},
                    SurfaceClaim{"ball", "Kh", "K", false, true, true},
                    // Turns about other axes are no news on a ball.
                    SurfaceClaim{"ball", "Kh", "Dinfh", false, false, false}));

TEST(ContinuousGroup, AxesAndPlacesAreFoundWithinLimits) {
  Scene scene;
  const std::vector<int> faces = scene.add(vase());
  const Region truth = make_region(group_named("Cinfv"), Vector3d::Zero(), GroupFrame::Identity(), faces, "");
  scene.expect({truth});
  const double size = diagonal(scene.mesh.vertices);
  // Tilted about the middle of the surface, so that the axis stays near it.
  Vector3d middle(0, 0, 0.52);
  for (const auto& [degrees, strict, loose] : {std::tuple{0.9, true, true}, std::tuple{1.1, false, true},
                                               std::tuple{2.9, false, true}, std::tuple{3.1, false, false}}) {
    const DetectionScore score =
        scene.score(Regions{moved_group(truth, Motion::rotation(Vector3d::UnitX(), degrees * kDegree, middle))});
    EXPECT_EQ(score.expected_regions[0].strict, strict) << degrees;
    EXPECT_EQ(score.expected_regions[0].loose, loose) << degrees;
    EXPECT_NEAR(score.expected_regions[0].axis_error.value(), degrees, 1e-9);
  }
  for (const auto& [percent, strict, loose] : {std::tuple{0.9, true, true}, std::tuple{1.1, false, true},
                                               std::tuple{2.9, false, true}, std::tuple{3.1, false, false}}) {
    const Motion aside{Eigen::Matrix3d::Identity(), Vector3d(percent / 100 * size, 0, 0)};
    const DetectionScore score = scene.score(Regions{moved_group(truth, aside)});
    EXPECT_EQ(score.expected_regions[0].strict, strict) << percent;
    EXPECT_EQ(score.expected_regions[0].loose, loose) << percent;
    EXPECT_NEAR(score.expected_regions[0].offset_error.value(), percent / 100, 1e-9);
  }
  // Along the axis there is nothing to find.
  const Motion along{Eigen::Matrix3d::Identity(), Vector3d(0, 0, 0.7)};
  EXPECT_TRUE(scene.score(Regions{moved_group(truth, along)}).expected_regions[0].strict);
}

// A large surface with a square in its middle of which symmetries are claimed.
struct Patch {
  std::string name;
  Vector3d (*place)(double u, double v);
  std::string claim;
  bool featureless;
};

void PrintTo(const Patch& patch, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's
  *out << patch.claim << " on " << patch.name;
}

Vector3d plane(double u, double v) {
  return {u - 0.5, v - 0.5, 0};
}
Vector3d cylinder(double u, double v) {
  return {u - 0.5, std::sin(5 * (v - 0.5)) / 5, (std::cos(5 * (v - 0.5)) - 1) / 5};
}
Vector3d dome(double u, double v) {
  const double x = u - 0.5;
  const double y = v - 0.5;
  return {x, y, std::sqrt(1 - x * x - y * y) - 1};
}
Vector3d bump(double u, double v) {
  const double x = u - 0.5;
  const double y = v - 0.5;
  return {x, y, 0.2 * std::exp(-20 * x * x - 60 * y * y)};
}

class FeaturelessPatch : public testing::TestWithParam<Patch> {};

TEST_P(FeaturelessPatch, SaysNothing) {
  constexpr int kCells = 60;
  Scene scene;
  scene.add(bent_grid(kCells, kCells, GetParam().place));
  std::vector<int> inside;
  for (int row = 20; row < 40; ++row) {
    for (int column = 20; column < 40; ++column) {
      inside.push_back(2 * (row * kCells + column));
      inside.push_back(2 * (row * kCells + column) + 1);
    }
  }
  scene.expect({});
  const DetectionScore score = scene.score(
      Regions{make_region(group_named(GetParam().claim), Vector3d::Zero(), GroupFrame::Identity(), inside, "")});
  EXPECT_GT(score.regions[0].validity, 0.95) << to_text(score);
  EXPECT_EQ(score.regions[0].trivial, GetParam().featureless ? Triviality::featureless : Triviality::none)
      << to_text(score);
  EXPECT_EQ(score.summary.precision, GetParam().featureless ? 0 : 1);
}

INSTANTIATE_TEST_SUITE_P(Patches, FeaturelessPatch,
                         testing::Values(Patch{"plane", plane, "C4v", true}, Patch{"plane", plane, "C2", true},
                                         Patch{"cylinder", cylinder, "C2v", true}, Patch{"dome", dome, "C4v", true},
                                         Patch{"bump", bump, "C2v", false}, Patch{"bump", bump, "C2", false}));

TEST(RegionValidity, IsTheShareThatStays) {
  // Of three balls two are images of one another.
  Scene scene;
  for (const Vector3d& place : {Vector3d(3, 0, 0), Vector3d(-3, 0, 0), Vector3d(5, 3, 0)}) {
    scene.add(moved_mesh(ball(), {Eigen::Matrix3d::Identity(), place}));
  }
  const std::vector<int> faces = members_of(scene.mesh);
  scene.expect({});
  const DetectionScore score =
      scene.score(Regions{make_region(group_named("Cs"), Vector3d::Zero(), frame_about(Vector3d::UnitX()), faces, "")});
  EXPECT_NEAR(score.regions[0].validity, 2.0 / 3, 0.01);
}

TEST(RegionValidity, LooksAtNormals) {
  // A wall and another one across it at the same place: points fall on the other wall's face only by their place.
  const auto strip = [](double height) {
    return bent_grid(100, 20, [height](double u, double v) { return Vector3d(u, 0.002 * v, height); });
  };
  const auto fence = [](double height) {
    return bent_grid(100, 20, [height](double u, double v) { return Vector3d(u, 0.001, height + 0.002 * (v - 0.5)); });
  };
  Scene scene;
  std::vector<int> faces = scene.add(strip(0.5));
  for (const int face : scene.add(fence(-0.5))) faces.push_back(face);
  scene.expect({});
  const DetectionScore score =
      scene.score(Regions{make_region(group_named("Cs"), Vector3d::Zero(), frame_about(Vector3d::UnitZ()), faces, "")});
  EXPECT_EQ(score.regions[0].validity, 0);
}

TEST(RegionValidity, ForgivesNormalsNextToCreases) {
  const auto flat = [](double height) {
    return bent_grid(100, 20, [height](double u, double v) { return Vector3d(u, 0.002 * v, height); });
  };
  const auto upright = [](double height) {
    return bent_grid(100, 20, [height](double u, double v) { return Vector3d(u, 0, height - height * 0.004 * v); });
  };
  // Above a ridge of two sides, below only one of them: as near, but turned by a right angle.
  Scene scene;
  std::vector<int> faces = scene.add(flat(0.5));
  for (const double height : {0.5, -0.5}) {
    for (const int face : scene.add(upright(height))) faces.push_back(face);
  }
  scene.expect({});
  const DetectionScore score =
      scene.score(Regions{make_region(group_named("Cs"), Vector3d::Zero(), frame_about(Vector3d::UnitZ()), faces, "")});
  EXPECT_EQ(score.regions[0].validity, 1);
}

}  // namespace
}  // namespace orbifit
