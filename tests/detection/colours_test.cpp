#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/detection/detect.h"
#include "orbifit/detection/surface_colours.h"
#include "orbifit/model/annotation_io.h"

#include "base/random.h"
#include "painted.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;
using test::Paint;
using test::Painter;

const Vector3d kWhite(1, 1, 1);
const Vector3d kRed(0.8, 0.1, 0.1);
const Vector3d kBlue(0.1, 0.2, 0.8);

struct Coloured {
  SymmetryAnnotation annotation;
  std::vector<BrokenByColours> broken;
};

Coloured detected(const Mesh& mesh, const Appearance& look) {
  const SurfaceColours colours(mesh, look);
  Coloured result;
  DetectOptions options;
  options.colours = &colours;
  options.broken_by_colours = &result.broken;
  RunContext context;
  result.annotation = detect(mesh, options, context);
  return result;
}

// The group of the region that has most faces; "" for none.
std::string group_of_whole(const Coloured& found) {
  const SymmetryAnnotation& annotation = found.annotation;
  const auto whole =
      std::ranges::max_element(annotation.regions, {}, [](const Region& region) { return region.faces.size(); });
  return whole == annotation.regions.end() ? "" : whole->group.symbol();
}

// What is told of the group that the shape has.
const BrokenByColours* broken(const Coloured& coloured, const std::string& group) {
  const auto found = std::ranges::find(coloured.broken, group, &BrokenByColours::group);
  return found == coloured.broken.end() ? nullptr : &*found;
}

class ColoursOf : public testing::TestWithParam<Paint> {};

TEST_P(ColoursOf, LeaveTheSubgroupThatKeepsThem) {
  const Mesh mesh = test::subdivided(test::box(1, 0.7, 0.4), 4);
  const Painter half = [](const Vector3d& p) { return p.x() > 0 ? kRed : kWhite; };
  const Coloured found = detected(mesh, test::painted(mesh, GetParam(), half));
  EXPECT_EQ(group_of_whole(found), "C2v");
  const BrokenByColours* told = broken(found, "D2h");
  ASSERT_NE(told, nullptr);
  EXPECT_EQ(told->kept_as, "C2v");
  EXPECT_GT(told->differing, 0.9);
}

TEST_P(ColoursOf, BearNoise) {
  const Mesh mesh = test::subdivided(test::box(1, 0.7, 0.4), 4);
  Random random(5);
  const Painter stripe = [&](const Vector3d& p) {
    const Vector3d noise(random.normal(), random.normal(), random.normal());
    return Vector3d((std::abs(p.x()) < 0.2 ? kBlue : Vector3d(0.7, 0.7, 0.6)) + 5.0 / 255 * noise);
  };
  const Coloured found = detected(mesh, test::painted(mesh, GetParam(), stripe));
  EXPECT_EQ(group_of_whole(found), "D2h");
  EXPECT_TRUE(found.broken.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, ColoursOf, testing::Values(Paint::vertices, Paint::faces, Paint::texture), [](const auto& kind) {
      return std::string(kind.param == Paint::vertices ? "Vertices" : kind.param == Paint::faces ? "Faces" : "Texture");
    });

TEST(Colours, OfMaterialsCount) {
  const Mesh mesh = test::subdivided(test::box(1, 0.7, 0.4), 2);
  Appearance look;
  look.materials = {{"white", {1, 1, 1, 1}, "", ""}, {"black", {0.1, 0.1, 0.1, 1}, "", ""}};
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const bool top = mesh.vertices(mesh.faces(f, 0), 2) > 0.199 && mesh.vertices(mesh.faces(f, 1), 2) > 0.199 &&
                     mesh.vertices(mesh.faces(f, 2), 2) > 0.199;
    look.material_of_face.push_back(top ? 1 : 0);
  }
  const Coloured found = detected(mesh, look);
  EXPECT_EQ(group_of_whole(found), "C2v");
}

TEST(Colours, ThatAreNotThereChangeNothing) {
  const Mesh mesh = test::box(1, 0.7, 0.4);
  EXPECT_TRUE(SurfaceColours(mesh, {}).uniform());
  Appearance grey;
  grey.colours = Appearance::Colours::Constant(3 * mesh.faces.rows(), 4, 0.5);
  EXPECT_TRUE(SurfaceColours(mesh, grey).uniform());
  RunContext context;
  EXPECT_EQ(to_json(detected(mesh, grey).annotation), to_json(detect(mesh, {}, context)));
}

TEST(Colours, OfOneOfAMirrorPairBreakTheMirror) {
  const Mesh part = test::subdivided(test::box(0.3, 0.5, 0.7), 3);
  const Mesh mesh = test::joined({test::moved(part, test::shift(-1, 0, 0)), test::moved(part, test::shift(1, 0, 0))});
  const Painter one = [](const Vector3d& p) { return p.x() > 0 ? kBlue : kWhite; };
  const Coloured found = detected(mesh, test::painted(mesh, Paint::faces, one));
  for (const Region& region : found.annotation.regions) {
    if (region.faces.size() < static_cast<std::size_t>(mesh.faces.rows())) continue;
    for (const Motion& element : region.elements) EXPECT_GT(element(Vector3d(1, 0, 0)).x(), 0) << region.name;
  }
  ASSERT_NE(broken(found, "D2h"), nullptr);
  EXPECT_EQ(broken(found, "D2h")->kept_as, "C2v");
  EXPECT_NEAR(broken(found, "D2h")->differing, 1, 1e-9);
  EXPECT_TRUE(found.annotation.patterns.empty());
}

TEST(Colours, AboutAnAxisLeaveItsFiniteRotations) {
  const Mesh mesh = test::subdivided(test::prism(96, 0.5, 0.8), 2);
  const auto sectors = [](int n) {
    return [n](const Vector3d& p) {
      return std::cos(n * std::atan2(p.y(), p.x())) > 0 || p.head<2>().norm() < 0.1 ? kWhite : kBlue;
    };
  };
  EXPECT_EQ(group_of_whole(detected(mesh, test::painted(mesh, Paint::texture, sectors(5)))), "D5h");
  EXPECT_EQ(group_of_whole(detected(mesh, test::painted(mesh, Paint::texture, sectors(1)))), "C2v");
  const Painter ring = [](const Vector3d& p) { return p.z() > 0.2 ? kRed : kWhite; };
  const Coloured found = detected(mesh, test::painted(mesh, Paint::texture, ring));
  EXPECT_EQ(group_of_whole(found), "Cinfv");
  ASSERT_NE(broken(found, "Dinfh"), nullptr);
  EXPECT_EQ(broken(found, "Dinfh")->kept_as, "Cinfv");
}

TEST(Colours, OfASpheresCapLeaveItsAxis) {
  const Mesh mesh = test::ball(64, 0.5);
  const Vector3d axis = Vector3d(1, 2, -0.5).normalized();
  const Painter cap = [&](const Vector3d& p) { return p.dot(axis) > 0.25 ? kRed : kWhite; };
  const Coloured found = detected(mesh, test::painted(mesh, Paint::texture, cap));
  EXPECT_EQ(group_of_whole(found), "Cinfv");
  ASSERT_FALSE(found.annotation.regions.empty());
  EXPECT_GT(std::abs(found.annotation.regions.front().axis.dot(axis)), 0.999);
}

TEST(Colours, OfAThinSheetsSidesAreTold) {
  const Mesh mesh = test::subdivided(test::box(1, 0.8, 0.002), 4);
  const Painter sides = [](const Vector3d& p) { return p.z() > 0 ? kRed : kWhite; };
  EXPECT_EQ(group_of_whole(detected(mesh, test::painted(mesh, Paint::faces, sides))), "C2v");
}

TEST(Colours, ThatCannotBeReadAreTold) {
  const Mesh mesh = test::box(1, 0.7, 0.4);
  Appearance look = test::painted(mesh, Paint::texture, [](const Vector3d&) { return kRed; });
  EXPECT_TRUE(SurfaceColours(mesh, look).problems().empty());
  EXPECT_NEAR((SurfaceColours(mesh, look).at(3, Vector3d(0.2, 0.3, 0.5)) - kRed).norm(), 0, 2.0 / 255);
  look.materials.front().image.resize(60);
  const SurfaceColours cut(mesh, look);
  ASSERT_EQ(cut.problems().size(), 1U);
  EXPECT_NE(cut.problems().front().find("'paint'"), std::string::npos) << cut.problems().front();
  EXPECT_EQ(cut.at(3, Vector3d(0.2, 0.3, 0.5)), kWhite);
}

}  // namespace
}  // namespace orbifit
