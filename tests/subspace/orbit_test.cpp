#include "symmetry/orbit.h"

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "basis/symmetric_basis.h"
#include "models/orbit_model.h"

namespace orbifit {
namespace {

// The orbit of a point on face 0, with its words.
struct Followed {
  explicit Followed(const RegionMap& map) : regions(map), words(map, true) {}
  Orbit of(const Eigen::Vector3d& seed) { return orbit_of(seed, regions.set_of_face(0), regions, words, {}); }

  const RegionMap& regions;
  GroupWords words;
};

// One triangle, so that a point's regions are known, with two regions of the groups given.
RegionMap two_regions(const std::vector<Motion>& a, const std::vector<Motion>& b, Mesh& mesh) {
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  annotation.regions.resize(2);
  annotation.regions[0].name = "left";
  annotation.regions[0].elements = a;
  annotation.regions[1].name = "right";
  annotation.regions[1].elements = b;
  for (Region& region : annotation.regions) {
    region.group = PointGroup{PointGroup::Family::Cs, 1};
    region.faces = {0};
  }
  return {mesh, annotation, RunContext{}};
}

std::vector<Motion> mirror(const Eigen::Vector3d& normal, const Eigen::Vector3d& point) {
  return {Motion{}, Motion::reflection(normal, point)};
}

TEST(Orbit, TwoMirrorsAtARightAngleGiveFourPoints) {
  Mesh mesh;
  const RegionMap regions = two_regions(mirror({1, 0, 0}, {0, 0, 0}), mirror({0, 1, 0}, {0, 0, 0}), mesh);
  const Orbit orbit = Followed(regions).of({0.3, 0.2, 0});
  EXPECT_EQ(orbit.points.size(), 4U);
  EXPECT_TRUE(orbit.constraints.empty());
}

TEST(Orbit, MirrorsAtThirtyDegreesCloseToADihedralOrbit) {
  Mesh mesh;
  const RegionMap regions = two_regions(
      mirror({1, 0, 0}, {0, 0, 0}), mirror(axis_rotation(Eigen::Vector3d::UnitZ(), M_PI / 6).col(0), {0, 0, 0}), mesh);
  EXPECT_EQ(Followed(regions).of({0.3, 0.2, 0}).points.size(), 12U);
}

TEST(Orbit, RegionsThatDoNotCloseAreNamed) {
  Mesh mesh;
  const RegionMap regions = two_regions(mirror({1, 0, 0}, {0, 0, 0}), mirror({1, 0, 0}, {0.7, 0, 0}), mesh);
  try {
    Followed(regions).of({0.3, 0.2, 0});
    FAIL() << "an endless orbit was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("left"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("right"), std::string::npos) << error.what();
  }
}

TEST(Orbit, APointOnAMirrorIsReachedTwice) {
  Mesh mesh;
  const RegionMap regions = two_regions(mirror({1, 0, 0}, {0, 0, 0}), {Motion{}}, mesh);
  Followed followed(regions);
  const Orbit orbit = followed.of({0, 0.2, 0});
  ASSERT_EQ(orbit.points.size(), 1U);
  ASSERT_EQ(orbit.constraints.size(), 1U);
  EXPECT_EQ(followed.words.transport(orbit.constraints[0].word).frame,
            Eigen::Matrix3d(Eigen::Vector3d(-1, 1, 1).asDiagonal()));
}

// However the axis lies, and though the foot of a point on it is computed to rounding only.
class OrbitOnAnAxis : public testing::TestWithParam<int> {};

TEST_P(OrbitOnAnAxis, MovesAlongItAlone) {
  Random random(static_cast<std::uint64_t>(GetParam()), "axis");
  const Eigen::Vector3d axis = random.direction();
  const Eigen::Vector3d centre = 10 * random.direction();
  Mesh mesh;
  SymmetryAnnotation annotation;
  two_regions({Motion{}}, {Motion{}}, mesh);
  annotation = empty_annotation(mesh, 0.005);
  Region region;
  region.name = "cone";
  region.group = PointGroup{PointGroup::Family::Cinf, 0};
  region.centre = centre;
  region.axis = axis;
  region.elements = {Motion::rotation(axis, 1, centre)};
  region.faces = {0};
  annotation.regions = {region};
  const RegionMap regions(mesh, annotation, RunContext{});
  GroupWords words(regions, true);
  ClosureOptions options;
  options.doublet = 1e-6;
  const Eigen::Vector3d beside = 1e-8 * axis.unitOrthogonal();
  const Orbit orbit = snapped_orbit_of(centre + 3.7 * axis + beside, regions.set_of_face(0), regions, words, options);
  ASSERT_EQ(orbit.points.size(), 1U);
  ASSERT_FALSE(orbit.constraints.empty());
  Eigen::MatrixXd asked(3 * static_cast<Eigen::Index>(orbit.constraints.size()), 3);
  for (std::size_t i = 0; i < orbit.constraints.size(); ++i) {
    asked.middleRows<3>(3 * static_cast<Eigen::Index>(i)) =
        words.transport(orbit.constraints[i].word).frame - Eigen::Matrix3d::Identity();
  }
  EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(asked).setThreshold(1e-9).rank(), 2);
  EXPECT_LT((asked * axis).norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Axes, OrbitOnAnAxis, testing::Range(0, 16));

// Two rods end on an axis at one place, each its own part; half-turns about the rods' middles take far ends there, to
// rounding only. Which end is seen from where is nothing that the field may depend on.
TEST(Orbit, OfAPointBesideAnotherPartIsTheSameFromEachOfItsPlaces) {
  constexpr double kOff = 1e-8;
  Mesh mesh;
  mesh.vertices.resize(6, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0.5, 0, 0.1, 0, 0, 0, -1, 0, 0, -0.5, 0, 0.1;
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 3, 4, 5;
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  annotation.regions.resize(3);
  const auto give = [&](std::size_t r, const Motion& motion, std::vector<int> faces) {
    annotation.regions[r].name = std::to_string(r);
    annotation.regions[r].elements = {Motion{}, motion};
    annotation.regions[r].generators = {motion};
    annotation.regions[r].group = PointGroup{PointGroup::Family::Cn, 2};
    annotation.regions[r].faces = std::move(faces);
  };
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  give(0, Motion::rotation(up, M_PI, Eigen::Vector3d::Zero()), {0, 1});
  give(1, Motion::rotation(up, M_PI, {0.5 + kOff, 0, 0}), {0});
  give(2, Motion::rotation(up, M_PI, {-0.5 - kOff, 0, 0}), {1});
  const RegionMap regions(mesh, annotation, RunContext{});
  GroupWords words(regions, true);
  ClosureOptions options;
  options.doublet = 1e-6;
  const int set = regions.set_of_face(0);
  const Eigen::Vector3d end(1, 0, 0);
  const Motion& turn = annotation.regions[1].elements[1];
  const Orbit here = snapped_orbit_of(end, set, regions, words, options);
  const Orbit there = snapped_orbit_of(turn(end), regions.carried_set(set, 1, 1), regions, words, options);
  ASSERT_EQ(here.points.size(), 4U);
  EXPECT_EQ(there.points.size(), here.points.size());
  EXPECT_EQ(here.constraints.size(), there.constraints.size());
  EXPECT_LT((turn(here.points.front().position) - there.points.front().position).norm(), 1e-15);
}

// Between two mirrors, nearer to each than points are told apart, and farther from the axis than that: it is on both
// mirrors, whichever of the points around the axis are met first.
class OrbitNearAnAxis : public testing::TestWithParam<int> {};

TEST_P(OrbitNearAnAxis, IsTheAxis) {
  constexpr double kDoublet = 1e-6;
  constexpr int kFold = 8;
  Mesh mesh;
  two_regions({Motion{}}, {Motion{}}, mesh);
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  const Eigen::Vector3d centre(0.3, -0.2, 0.1);
  annotation.regions = {
      make_region({PointGroup::Family::Cnv, kFold}, centre, Random(GetParam(), "frame").rotation(), {0}, "ring")};
  const RegionMap regions(mesh, annotation, RunContext{});
  GroupWords words(regions, true);
  ClosureOptions options;
  options.doublet = kDoublet;
  const double radius = 0.7 * kDoublet / (2 * std::sin(M_PI / (2 * kFold)));
  const Region& ring = annotation.regions[0];
  const Motion* mirror = nullptr;
  for (const Motion& element : ring.elements) {
    if (element.linear.determinant() < 0) mirror = &element;
  }
  ASSERT_NE(mirror, nullptr);
  // Across the mirror, then half of the angle between two of them.
  const Eigen::Vector3d normal = (Eigen::Matrix3d::Identity() - mirror->linear).col(0).stableNormalized();
  const Motion turn = Motion::rotation(ring.axis, M_PI / 2 + M_PI / (2 * kFold), Eigen::Vector3d::Zero());
  const Eigen::Vector3d seed = centre + 0.2 * ring.axis + radius * (turn.linear * normal);
  for (const Motion& element : ring.elements) {
    const Orbit orbit = snapped_orbit_of(element(seed), regions.set_of_face(0), regions, words, options);
    EXPECT_EQ(orbit.points.size(), 1U);
    EXPECT_LT((orbit.points.front().position - centre).cross(ring.axis).norm(), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Frames, OrbitNearAnAxis, testing::Range(0, 16));

TEST(Orbit, FixedPointIsFixedAndNearest) {
  const Motion a = Motion::reflection({1, 0, 0}, {0.1, 0, 0});
  const Motion b = Motion::reflection({0, 1, 0}, {0, -0.2, 0});
  const Eigen::Vector3d fixed = fixed_point({0.3, 0.4, 0.5}, {a, b});
  EXPECT_LT((fixed - Eigen::Vector3d(0.1, -0.2, 0.5)).norm(), 1e-14);
}

class OrbitOfGroup : public testing::TestWithParam<const char*> {};

TEST_P(OrbitOfGroup, OfAGenericPointHasTheGroupsOrderAndFrames) {
  OrbitOptions options;
  options.frame = Random(3, GetParam()).rotation();
  options.centre = {0.3, -0.2, 0.7};
  const PointGroup group = PointGroup::parse(GetParam()).value();
  const GeneratedModel model = generate_orbit(group, options);
  const RegionMap regions(model.mesh, model.truth, RunContext{});
  const Eigen::Vector3d seed = model.mesh.vertices.row(0);
  Followed followed(regions);
  const Orbit orbit = followed.of(seed);
  ASSERT_EQ(static_cast<int>(orbit.points.size()), group.order());
  EXPECT_TRUE(orbit.constraints.empty());
  for (const OrbitPoint& point : orbit.points) {
    const Motion& motion = followed.words.motion(point.word);
    const Transport& transport = followed.words.transport(point.word);
    EXPECT_LT((motion(seed) - point.position).norm(), 1e-13);
    EXPECT_LT((motion.linear - transport.frame).norm(), 1e-13);
    // A common translation t of seed and group moves every image by t: frame t + (1 - frame) t.
    ASSERT_LE(transport.carried.size(), 1U);
    if (!transport.carried.empty()) {
      EXPECT_LT((transport.frame + transport.carried[0].second - Eigen::Matrix3d::Identity()).norm(), 1e-13);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Groups, OrbitOfGroup,
                         testing::Values("Cs", "Ci", "C2", "C5", "C4v", "C6h", "D3", "D4h", "D3d", "S4", "S6", "T",
                                         "Td", "Th", "O", "Oh", "I", "Ih"));

}  // namespace
}  // namespace orbifit
