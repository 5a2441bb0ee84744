#include "cases/bending.h"

#include <cmath>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/motion.h"

namespace orbifit {

namespace {

// Two triangles that share the y axis from 0 to 1, the second of which is turned up by an angle.
Mesh folded(double angle, bool turned_round = false) {
  Mesh mesh;
  mesh.vertices.resize(4, 3);
  mesh.vertices << 0, 0, 0, 0, 1, 0, -1, 0, 0, std::cos(angle), 0, std::sin(angle);
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 1, 0, 3;
  if (turned_round) mesh.faces.row(1) << 0, 1, 3;
  return mesh;
}

}  // namespace

TEST(Bending, IsTheChangeOfTheDihedralAngle) {
  for (const bool turned_round : {false, true}) {
    for (const double angle : {-2.0, -0.3, 0.0, 0.4, 1.5}) {
      const Bending found = bending(folded(0.2, turned_round), folded(0.2 + angle, turned_round));
      EXPECT_NEAR(found.rms, std::abs(angle), 1e-12);
      EXPECT_NEAR(found.of_vertex[0], std::abs(angle), 1e-12);
      EXPECT_EQ(found.of_vertex[2], 0);  // of no inner edge
    }
  }
}

TEST(Bending, TakesTheShorterWayRound) {
  const double pi = std::acos(-1.0);
  EXPECT_NEAR(bending(folded(0.9 * pi), folded(-0.9 * pi)).rms, 0.2 * pi, 1e-12);
}

TEST(Bending, IsNoneOfMotionsAndScales) {
  const Mesh mesh = generate("armchair", {}).mesh;
  Mesh moved = mesh;
  const Motion motion = Motion::rotation(Eigen::Vector3d(1, 2, 3).normalized(), 1.1, Eigen::Vector3d(4, 5, 6));
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    moved.vertices.row(v) = 3.7 * motion(mesh.vertices.row(v).transpose()).transpose();
  }
  EXPECT_LT(bending(mesh, moved).rms, 1e-6);
}

TEST(Bending, LeavesOutWhatHasNoAngle) {
  Mesh mesh = folded(0.1);
  mesh.faces.conservativeResize(3, 3);
  mesh.faces.row(2) << 0, 1, 3;  // a third face at the edge
  Mesh more = folded(1);
  more.faces = mesh.faces;
  EXPECT_EQ(bending(mesh, more).rms, 0);
  Mesh flat = folded(0.1);
  flat.vertices.row(3) = flat.vertices.row(0);
  EXPECT_EQ(bending(flat, folded(1)).rms, 0);
  EXPECT_EQ(bending(Mesh{}, Mesh{}).rms, 0);
}

}  // namespace orbifit
