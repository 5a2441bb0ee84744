// Spheres among the pieces of a surface, and regions that are little else.

#include "primitives/balls.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "placements.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

const Vector3d kCentre(0.4, -0.3, 0.2);

// A ball beside a box.
PreparedMesh ball_and_box() {
  return prepare(test::joined({test::moved(test::ball(24, 1), test::shift(kCentre.x(), kCentre.y(), kCentre.z())),
                               test::moved(test::box(1, 1.2, 0.8), test::shift(3, 0, 0))}));
}

GroupPlacement placed(const PreparedMesh& prepared, const std::string& symbol, const Vector3d& centre) {
  return test::normalised(prepared, {*PointGroup::parse(symbol), GroupFrame::Identity(), centre});
}

// The faces of a component that lie below a height.
std::vector<int> below(const PreparedMesh& prepared, int component, double height) {
  std::vector<int> faces;
  for (const int face : prepared.components.faces[static_cast<std::size_t>(component)]) {
    double z = 0;
    for (const int vertex : prepared.mesh.faces.row(face)) {
      z += prepared.input_of_normalised(Vector3d(prepared.mesh.vertices.row(vertex))).z() / 3;
    }
    if (z < height) faces.push_back(face);
  }
  return faces;
}

TEST(Balls, AreFoundWhereTheyAre) {
  const PreparedMesh prepared = ball_and_box();
  const Balls balls = find_balls(prepared, test::kTolerance);
  ASSERT_EQ(balls.all.size(), 1U);
  for (std::size_t f = 0; f < balls.ball_of_face.size(); ++f) {
    EXPECT_EQ(balls.ball_of_face[f], prepared.components.component_of_face[f] == 0 ? 0 : -1);
  }
  const GroupPlacement there = placed(prepared, "Cs", kCentre);
  EXPECT_LT((balls.all[0].centre - there.centre).norm(), 1e-3);
  EXPECT_NEAR(balls.all[0].area, area_of(prepared, prepared.components.faces[0]), 1e-12);
}

// A ball that goes over into a bump on its top, all of one piece: up to some angle from the top it is drawn out.
Mesh drawn_out(double angle) {
  Mesh mesh = test::ball(60, 1);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const double from_top = std::acos(std::clamp(mesh.vertices(v, 2), -1.0, 1.0));
    if (from_top < angle) mesh.vertices.row(v) *= 1.5 - 0.5 * from_top / angle;
  }
  return mesh;
}

TEST(Balls, AreFoundUnderWhatStandsOnThem) {
  const PreparedMesh prepared = prepare(drawn_out(1.2));
  const Balls balls = find_balls(prepared, test::kTolerance);
  ASSERT_EQ(balls.all.size(), 1U);
  const double size = prepared.input_of_normalised.scale;
  EXPECT_LT((balls.all[0].centre - placed(prepared, "Cs", Vector3d::Zero()).centre).norm(), test::kTolerance);
  EXPECT_NEAR(size * balls.all[0].radius, 1, 0.01);
  for (std::size_t f = 0; f < balls.ball_of_face.size(); ++f) {
    double far = 0;
    double near = 10;
    for (const int vertex : prepared.mesh.faces.row(static_cast<Eigen::Index>(f))) {
      const double radius = prepared.input_of_normalised(Vector3d(prepared.mesh.vertices.row(vertex))).norm();
      far = std::max(far, radius);
      near = std::min(near, radius);
    }
    if (far < 1.001) {
      EXPECT_EQ(balls.ball_of_face[f], 0);
    }
    if (near > 1.1) {
      EXPECT_EQ(balls.ball_of_face[f], -1);
    }
  }
}

TEST(Balls, AreNotFoundInWhatIsRoundButNoBall) {
  // No sphere holds much of an egg.
  Mesh egg = test::ball(60, 1);
  egg.vertices.col(2) *= 1.3;
  EXPECT_TRUE(find_balls(prepare(egg), test::kTolerance).all.empty());
}

struct Fixing {
  const char* group;
  Vector3d centre;
  bool fixes;
};

class BallUnder : public testing::TestWithParam<Fixing> {};

TEST_P(BallUnder, StaysIfTheGroupFixesItsCentre) {
  const auto& [group, centre, expected] = GetParam();
  const PreparedMesh prepared = ball_and_box();
  const Ball ball = find_balls(prepared, test::kTolerance).all.at(0);
  EXPECT_EQ(fixes(placed(prepared, group, kCentre + centre), ball, test::kTolerance), expected);
}

INSTANTIATE_TEST_SUITE_P(Groups, BallUnder,
                         testing::Values(Fixing{"Cs", {0, 0, 0}, true}, Fixing{"Cs", {2, 1, 0}, true},
                                         Fixing{"Cs", {0, 0, 0.2}, false}, Fixing{"C5", {0, 0, 3}, true},
                                         Fixing{"C5", {0.2, 0, 0}, false}, Fixing{"D3h", {0, 0, 0.2}, false},
                                         Fixing{"Ih", {0, 0, 0}, true}, Fixing{"Cinfv", {0, 0, 1}, true}),
                         [](const auto& each) {
                           return std::string(each.param.group) + (each.param.fixes ? "There" : "Elsewhere") +
                                  std::to_string(each.index);
                         });

TEST(Balls, SayNothingOfGroupsThatKeepSomeOfThem) {
  const PreparedMesh prepared = ball_and_box();
  const Balls balls = find_balls(prepared, test::kTolerance);
  const std::vector<int> part = below(prepared, 0, kCentre.z() + 0.5);
  ASSERT_LT(part.size(), prepared.components.faces[0].size());
  const auto little = [&](const std::vector<int>& faces, const Vector3d& centre) {
    return little_but_cut_balls(prepared, balls, faces, placed(prepared, "C4v", centre), test::kTolerance);
  };
  EXPECT_TRUE(little(part, kCentre));
  EXPECT_FALSE(little(part, kCentre + Vector3d(0.5, 0, 0))) << "it moves the ball";
  EXPECT_FALSE(little(prepared.components.faces[0], kCentre)) << "all of it";
  std::vector<int> with_box = part;
  with_box.insert(with_box.end(), prepared.components.faces[1].begin(), prepared.components.faces[1].end());
  EXPECT_FALSE(little(with_box, kCentre)) << "much else";
}

}  // namespace
}  // namespace orbifit
