// Where regions end: at creases and joints, or anywhere.

#include "surface/smooth_border.h"

#include <functional>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

struct Ended {
  const char* name;
  Mesh mesh;
  std::function<bool(const Vector3d&)> in;  // by the middle of a face
  double least, most;                       // of the share

  friend void PrintTo(const Ended& ended, std::ostream* out) { *out << ended.name; }
};

class Border : public testing::TestWithParam<Ended> {};

TEST_P(Border, IsSmoothAsFarAsItIs) {
  const auto& [name, mesh, in, least, most] = GetParam();
  const PreparedMesh prepared = prepare(mesh);
  std::vector<int> faces;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    Vector3d middle = Vector3d::Zero();
    for (const int vertex : mesh.faces.row(f)) middle += mesh.vertices.row(vertex).transpose() / 3;
    if (in(middle)) faces.push_back(f);
  }
  const double share = smooth_border_share(prepared, face_sides(prepared), faces, test::kTolerance);
  EXPECT_GE(share, least);
  EXPECT_LE(share, most);
}

Mesh fine_box() {
  return test::subdivided(test::box(1, 1, 1), 6);
}

TEST(Border, IsNotSmoothWhereItIsExcused) {
  const Mesh mesh = fine_box();
  const PreparedMesh prepared = prepare(mesh);
  std::vector<int> upper;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    if (mesh.vertices(mesh.faces.row(f), 2).mean() > 0.1) upper.push_back(f);
  }
  const auto share = [&](const std::function<bool(const Vector3d&)>& excused) {
    return smooth_border_share(prepared, face_sides(prepared), upper, test::kTolerance, excused);
  };
  EXPECT_EQ(share([](const Vector3d&) { return true; }), 0);
  EXPECT_EQ(share([](const Vector3d&) { return false; }), share({}));
  EXPECT_NEAR(share([](const Vector3d& middle) { return middle.x() > 0; }), 0.5 * share({}), 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, Border,
    testing::Values(Ended{"AllOfABox", fine_box(), [](const Vector3d&) { return true; }, 0, 0},
                    Ended{"OneFace", fine_box(), [](const Vector3d& x) { return x.z() > 0.4999; }, 0, 0.05},
                    Ended{"HalfOfABox", fine_box(), [](const Vector3d& x) { return x.z() > 0.1; }, 0.85, 1},
                    Ended{"QuarterOfAFace", fine_box(),
                          [](const Vector3d& x) { return x.z() > 0.4999 && x.x() > 0.02 && x.y() > 0.02; }, 0.4, 0.6},
                    Ended{"CapOfABall", test::ball(160, 1), [](const Vector3d& x) { return x.z() > 0.3; }, 0.99, 1}),
    [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace orbifit
